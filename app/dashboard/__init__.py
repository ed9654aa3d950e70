"""The dashboard of one visitor: controller, main picture, layout and tabs."""
