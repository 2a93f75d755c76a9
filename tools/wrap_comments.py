#!/usr/bin/env python3
"""Wraps comments of Rust files at 100 columns: tools/wrap_comments.py FILE ...

Only paragraphs with a longer line are changed; the stable rustfmt leaves comments as they are.
"""

import re
import sys
import textwrap
from pathlib import Path

LIMIT = 100
COMMENT = re.compile(r"^(\s*)(//[/!]?) ?(.*)$")
ITEM = re.compile(r"^([-*] |\d+\. )?")


def wrapped(paragraph, prefix):
    """A paragraph as lines; as it is if every line fits."""
    lines = [(prefix + text).rstrip() for text in paragraph]
    if all(len(line) <= LIMIT for line in lines):
        return lines
    hang = " " * len(ITEM.match(paragraph[0]).group(0))
    text = " ".join(text.strip() for text in paragraph)
    keep = {"break_long_words": False, "break_on_hyphens": False}
    return textwrap.wrap(text, LIMIT, initial_indent=prefix, subsequent_indent=prefix + hang, **keep)


def block(texts, prefix):
    """A comment: blank lines, tables, headings, code and the items of lists end a paragraph."""
    lines, paragraph, code = [], [], False
    for text in texts:
        fence = text.startswith("```")
        code ^= fence
        if fence or code or not text.strip() or text.startswith(("    ", "|", "#")):
            lines += wrapped(paragraph, prefix) if paragraph else []
            lines.append((prefix + text).rstrip())
            paragraph = []
            continue
        if paragraph and ITEM.match(text).group(0):
            lines += wrapped(paragraph, prefix)
            paragraph = []
        paragraph.append(text)
    return lines + (wrapped(paragraph, prefix) if paragraph else [])


def wrap(path):
    before = path.read_text(encoding="utf-8")
    lines, out, i = before.split("\n"), [], 0
    while i < len(lines):
        match = COMMENT.match(lines[i])
        if not match:
            out.append(lines[i])
            i += 1
            continue
        head, texts = match.groups()[:2], []
        while i < len(lines) and (match := COMMENT.match(lines[i])) and match.groups()[:2] == head:
            texts.append(match.group(3))
            i += 1
        out += block(texts, "".join(head) + " ")
    after = "\n".join(out)
    if after != before:
        path.write_text(after, encoding="utf-8")


if __name__ == "__main__":
    for name in sys.argv[1:]:
        wrap(Path(name))
