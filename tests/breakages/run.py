#!/usr/bin/env python3
"""Mutation tests: breaks the program on purpose, one thing at a time, and sees which test notices.

    tests/breakages/run.py [SHARD/SHARDS]     tries its part of table.toml, all without an argument
    tests/breakages/run.py case NAME...       tries those that these cases claim: 57, plan
    tests/breakages/run.py untried            tries those that the page calls "not tried"
    tests/breakages/run.py page               makes docs/breakages.md of what was tried

Breakages are made in a copy of the sources under target/breakages, never in the sources. The copy is
compiled once, without the window and for one level of instructions, with the sound and the broken body
of each function (mutant schemata: Untch, Offutt and Harrold, ISSTA 1993); an environment variable says
which one runs. What lies outside of functions is compiled alone, and so is `alone = true`. What came of
a breakage is kept, one line each, so that shards may run one after the other or on several machines. A
breakage that no longer fits the sources, or that is not compiled, is an error, and so is a case that
fails in the sound copy.

A case is the number of a hard case, or the name of a proof.
"""
import collections
import datetime
import os
import pathlib
import re
import subprocess
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
WORK = ROOT / "target" / "breakages"
TABLE = tomllib.loads((ROOT / "tests/breakages/table.toml").read_text())["breakage"]
UNTRIED = "not tried"

# Beginnings of functions whose body runs at run time, as rustfmt writes them. A declaration without a body
# ends in a semicolon, which types of arrays contain, too.
ARRAY = r"\[(?:[^][]|\[(?:[^][]|\[[^][]*\])*\])*\]"
FUNCTION = re.compile(rf"^( *)(?:pub(?:\([\w ]+\))? )?(?:unsafe )?fn (?:[^][;{{}}]|{ARRAY})*\{{\n", re.MULTILINE)
# The environment variable with the number of the breakage that runs.
BROKEN = "MARRAZTU_BROKEN"
SWITCH = f"""
static NUMBER: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(u32::MAX);

/// Whether this breakage runs. Kernels ask for each pixel.
#[inline(always)]
#[must_use]
pub fn broken(number: u32) -> bool {{
    let own = NUMBER.load(std::sync::atomic::Ordering::Relaxed);
    (if own == u32::MAX {{ read() }} else {{ own }}) == number
}}

#[cold]
fn read() -> u32 {{
    let number = std::env::var("{BROKEN}").ok().and_then(|text| text.parse().ok());
    let number = number.unwrap_or(u32::MAX - 1);
    NUMBER.store(number, std::sync::atomic::Ordering::Relaxed);
    number
}}
"""


def output(*command, **options):
    return subprocess.run(command, capture_output=True, text=True, **options)


def copy(to, changed):
    """Brings a copy of the sources up to date, without touching what is the same there."""
    listed = output("git", "ls-files", "-co", "--exclude-standard", cwd=ROOT).stdout.split("\n")
    for name in filter(None, listed):
        source, target = ROOT / name, to / name
        if not source.is_file():
            continue
        data = changed[name].encode() if name in changed else source.read_bytes()
        if name == ".cargo/config.toml":
            data = data.replace(b"rustflags = [", b'rustflags = ["--cfg=one_level", ')
        put(target, data)


def put(target, data):
    target.parent.mkdir(parents=True, exist_ok=True)
    if not target.is_file() or target.read_bytes() != data:
        target.write_bytes(data)


def run(where, target, *names, number=""):
    """Compiles and runs a test target."""
    run = output(
        "cargo", "test", "--locked", "--no-default-features", "--features", "cli", "--target-dir", WORK / "build",
        "--test", target, "--", *names, cwd=where, env=os.environ | {BROKEN: number},
    )
    if f"Running tests/{target}" not in run.stderr:
        sys.exit(f"run.py: not compiled:\n{run.stderr}")
    return run


def hard_cases(where, *names, number=""):
    """The hard cases that fail, by name."""
    tried = run(where, "hard_cases", *names, number=number)
    failed = re.findall(r"^test (?:\w+::)*(\w+) \.\.\. FAILED", tried.stdout, re.MULTILINE)
    if tried.returncode and not failed:
        # The whole process ended: a crash is noticed, too.
        failed = ["the process ended"]
    return failed


def claimed(where, case, number=""):
    """What fails of the tests that claim a case."""
    if isinstance(case, int):
        return hard_cases(where, f"case_{case}_", number=number)
    if case == "paths":
        return ["the test of colour paths"] if run(where, "paths", number=number).returncode else []
    return [f"the proof {case}"] if run(where, "proofs", case, number=number).returncode else []


def broken(text, breakage):
    if text.count(breakage["from"]) != 1:
        sys.exit(f"run.py: {breakage['file']} does not have once what breaks case {breakage['case']}:"
                 f" {breakage['what']}")
    return text.replace(breakage["from"], breakage["to"])


def body(text, breakage):
    """The range of the body of the innermost function around a breakage, or None."""
    begin = text.index(breakage["from"])
    found = None
    for function in FUNCTION.finditer(text):
        end = text.find(f"\n{function[1]}}}\n", function.end() - 1) + 1
        if function.end() <= begin and begin + len(breakage["from"]) <= end:
            found = (function.end(), end)
    return None if breakage.get("alone") else found


def switched(text, bodies, file):
    """A file in which each of these bodies, {range: numbers of breakages}, is a choice among all its versions."""
    here = "crate" if file.startswith("crates/core/src/") else "marraztu_core"
    for (begin, end), numbers in sorted(bodies.items(), reverse=True):
        sound = text[begin:end]
        versions = [f"if {here}::broken({i}) {{\n{broken(sound, TABLE[i])}}} else " for i in numbers]
        text = f"{text[:begin]}{''.join(versions)}{{\n{sound}}}\n{text[end:]}"
    return text


def schemata(mine):
    """The sources with all breakages of functions in them, and the numbers of these breakages."""
    bodies = collections.defaultdict(lambda: collections.defaultdict(list))
    for i in mine:
        file = TABLE[i]["file"]
        if (where := body((ROOT / file).read_text(), TABLE[i])):
            bodies[file][where].append(i)
    library = "crates/core/src/lib.rs"
    texts = {file: switched((ROOT / file).read_text(), bodies[file], file) for file in bodies}
    texts[library] = texts.get(library, (ROOT / library).read_text()) + SWITCH
    return texts, {i for those in bodies.values() for numbers in those.values() for i in numbers}


def attempt(mine, where):
    for breakage in TABLE:
        broken((ROOT / breakage["file"]).read_text(), breakage)
    texts, together = schemata(mine)
    copy(where, texts)
    # That of the copy: the sources may move on.
    commit = output("git", "describe", "--always", "--dirty", "--exclude", "*", cwd=ROOT).stdout.strip()
    for case in sorted({TABLE[i]["case"] for i in mine}, key=str):
        if failed := claimed(where, case):
            sys.exit(f"run.py: fails unbroken: {', '.join(failed)}")
    # Those in one program first.
    for i in sorted(mine, key=lambda i: i not in together):
        breakage, number = TABLE[i], str(i)
        if i not in together:
            copy(where, {breakage["file"]: broken((ROOT / breakage["file"]).read_text(), breakage)})
        caught = claimed(where, breakage["case"], number)
        # Not by the case that claims it: by any?
        others = [] if caught else hard_cases(where, number=number)
        today = datetime.datetime.now(datetime.timezone.utc).date().isoformat()
        came = "caught" if caught else "only by others" if others else "SURVIVED"
        line = "\t".join([today, commit, came, ", ".join(caught or others)])
        (WORK / f"{key(breakage)}.tsv").write_text(line + "\n")
        print(f"{i + 1}/{len(TABLE)} case {breakage['case']}: {breakage['what']}: {line}", flush=True)


def key(breakage):
    words = re.sub(r"[^a-z0-9]+", "-", breakage["what"].lower()).strip("-")
    return f"{breakage['case']:0>2}-{words}"


def told():
    """The last columns of each row of the page as it is: what came of a breakage, by what, and when."""
    rows = (line.strip("| \n").split(" | ") for line in (ROOT / "docs/breakages.md").read_text().splitlines())
    return {(row[0], row[1]): row[3:] for row in rows if len(row) == 6}


def results():
    """What came of each breakage: here, or where the page as it is was made."""
    before = told()
    for breakage in TABLE:
        kept = WORK / f"{key(breakage)}.tsv"
        if kept.is_file():
            day, commit, came, by = kept.read_text().strip("\n").split("\t")
            more = by.count(",")
            named = by.split(", ")[0].replace("_", " ") + (f" and {more} more" if more else "")
            yield [came, named, f"{day} {commit}"]
        else:
            yield before.get((str(breakage["case"]), breakage["what"]), [UNTRIED, "", ""])


def page():
    rows, missing, untried = [], 0, 0
    for breakage, result in zip(TABLE, results()):
        missing += result[0] != "caught"
        untried += result[0] == UNTRIED
        file = breakage["file"].removeprefix("crates/")
        rows.append(f"| {breakage['case']} | {breakage['what']} | `{file}` | {' | '.join(result)} |")
    text = f"""# Mutation tests

<!-- Made by tests/breakages/run.py page: change tests/breakages, and run it again. -->

Each row is a mistake that was made on purpose in a copy of the sources, alone, and the test that failed
for it. The first column names the hard case, or the proof, that has to notice.
{len(TABLE)} mistakes, {len(TABLE) - missing} caught by the case that claims them, {untried} not tried yet.

`tests/breakages/run.py 1/4` tries a quarter of them, `tests/breakages/run.py page` makes this page.

| case | mistake | in | result | by | tried |
|--:|---|---|---|---|---|
""" + "\n".join(rows) + "\n"
    (ROOT / "docs/breakages.md").write_text(text)
    print(f"docs/breakages.md: {len(TABLE) - missing} of {len(TABLE)} caught")


def main():
    argument, *numbers = sys.argv[1:] or ["1/1"]
    if argument == "page":
        return page()
    if argument == "case":
        mine = [i for i, breakage in enumerate(TABLE) if str(breakage["case"]) in numbers]
        return attempt(mine, WORK / "shard-1")
    if argument == "untried":
        mine = [i for i, result in enumerate(results()) if result[0] == UNTRIED]
        return attempt(mine, WORK / "shard-1")
    shard, shards = map(int, argument.split("/"))
    attempt(range(shard - 1, len(TABLE), shards), WORK / f"shard-{shard}")


if __name__ == "__main__":
    main()
