"""The dashboard of one session: controller, main picture, layout and tabs."""
