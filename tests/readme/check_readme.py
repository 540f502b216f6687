#!/usr/bin/python3
"""What READMEs show is what is run: each region of a C or JavaScript file, between /* [name */ and /* name] */, stands in
every page. usage: check_readme.py FILE.c|FILE.mjs PAGE.md..."""
import re
import sys
import textwrap


def main():
    with open(sys.argv[1], encoding="utf-8") as stream:
        regions = re.findall(r"^ */\* \[([^*]+) \*/\n(.*?)^ */\* \1\] \*/$", stream.read(), re.MULTILINE | re.DOTALL)
    if not regions:
        sys.exit(f"{sys.argv[1]} has no regions")
    language = "js" if sys.argv[1].endswith(".mjs") else "c"
    for page in sys.argv[2:]:
        with open(page, encoding="utf-8") as stream:
            text = stream.read()
        for name, lines in regions:
            lines = textwrap.dedent(lines)
            if f"```{language}\n" + lines + "```" not in text:
                sys.exit(f"{page} does not show '{name}' of {sys.argv[1]}:\n{lines}")


main()
