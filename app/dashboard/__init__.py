"""The dashboard of one session: controller, main picture, playback, layout, tabs and the table of pages."""
