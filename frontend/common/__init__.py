"""What all languages and files share: source texts, lines, numbers, drawings."""
