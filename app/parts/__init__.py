"""What is always on the page, a folder for each part, and what all parts and pages are made of."""
