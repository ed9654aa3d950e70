"""The granchain command line and dashboard. Nothing in `granchain_core` knows them."""
