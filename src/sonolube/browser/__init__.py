"""The workbench in the browser: tasks over HTTP, and pages that show their answers without physics of their own."""
