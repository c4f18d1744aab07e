"""The `urbanverse` command: one module per sub-command, each with `main(argv) -> exit status`."""
