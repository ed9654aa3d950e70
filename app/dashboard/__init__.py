"""The dashboard of one session: controller, main picture, playback, layout, tabs, the table of pages."""
