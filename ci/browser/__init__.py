"""The test of a report in a browser: a client of the browser, and the checks of what a reader sees and does."""
