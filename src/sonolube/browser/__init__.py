"""The workbench in the browser: tasks over HTTP, and pages that show their answers. No physics, unit or range in a page."""
