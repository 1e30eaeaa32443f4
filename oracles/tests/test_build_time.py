"""`ci/build-time`: growth beyond a tolerance fails, names of functions are read, and a log tells when one core was busy."""

import json
from pathlib import Path

import pytest
from build_time import counts, functions, times, wrapper
from build_time.cargo import FailedError
from build_time.counts import Build, Crate

ROOT = Path(__file__).resolve().parents[2]
#: Lines of the baseline.
LINES = {"featherbench-spatial": 1000, "featherbench-dynamics": 9000}
OTHERS = {"serde": 1, "syn": 2}
IR = """\
; core::fmt
define internal noundef i8 @_RNvNtC4core3fmt5write(ptr %a) unnamed_addr #0 personality ptr @rust_eh_personality {
start:
  %0 = alloca [8 x i8], align 8
; call core::f
  switch i8 %1, label %bb2 [
    i8 0, label %bb3
  ]

bb2:                                              ; preds = %start
  ret i8 1
}

declare i32 @rust_eh_personality(i32)

define void @"_ZN3std2rt10lang_start28_$u7b$$u7b$closure$u7d$$u7d$17he39bdf0230cb3880E"(ptr %f) {
  ret void
}
"""


def build(lines: dict[str, int], others: dict[str, int] = OTHERS) -> Build:
    """What a build asks of the compiler."""
    return Build({name: Crate(number, number // 40) for name, number in lines.items()}, others)


@pytest.mark.parametrize(
    ("lines", "others"),
    [
        (LINES, OTHERS),
        # A small crate at its limit.
        (LINES | {"featherbench-spatial": 1100}, OTHERS),
        # Less, and what is gone.
        ({"featherbench-dynamics": 100}, {"serde": 1}),
        # Another package, and one version less of a second one.
        (LINES, {"serde": 1, "syn": 1, "quote": 1}),
    ],
)
def test_what_is_light_passes(lines: dict[str, int], others: dict[str, int]) -> None:
    """Growth within the tolerances, shrinkage, and an exchange of packages are no finding."""
    assert counts.heavier(build(LINES), build(lines, others), True) == []


@pytest.mark.parametrize(
    ("lines", "others", "told"),
    [
        (LINES | {"featherbench-spatial": 1101}, OTHERS, "featherbench-spatial: +10.10% lines, and 10% is the limit"),
        (LINES | {"featherbench-dynamics": 9301}, OTHERS, "all crates together: +3.01% lines, and 3% is the limit"),
        (LINES | {"featherbench-new": 1}, OTHERS, "featherbench-new is not in the baseline"),
        (LINES, OTHERS | {"quote": 1}, "4 packages of others, and were 3. With more versions, or new: quote"),
        (LINES, {"serde": 2, "syn": 2}, "4 packages of others, and were 3. With more versions, or new: serde"),
    ],
)
def test_what_is_heavier_is_told(lines: dict[str, int], others: dict[str, int], told: str) -> None:
    """A crate, all crates, a new crate, a new package and a second version of one are told."""
    assert counts.heavier(build(LINES), build(lines, others), True) == [told]


def test_another_compiler_judges_no_lines() -> None:
    """Packages and new crates do not depend on the compiler. Lines do."""
    now = build({"featherbench-spatial": 2000, "featherbench-dynamics": 18000, "featherbench-new": 1}, OTHERS | {"quote": 1})
    assert len(counts.heavier(build(LINES), now, True)) == 5
    assert len(counts.heavier(build(LINES), now, False)) == 2


def test_the_table_has_what_is_new_and_what_is_gone() -> None:
    """The largest crate is first, and the sum last."""
    table = counts.sizes(build(LINES), build({"featherbench-new": 40, "featherbench-dynamics": 9900}))
    assert table[2:] == [
        "| featherbench-dynamics | 9,900 | 247 | 9,000 | +10.00% |",
        "| featherbench-new | 40 | 1 | – | new |",
        "| featherbench-spatial | – | – | 1,000 | gone |",
        "| **all** | 9,940 | 248 | 10,000 | -0.60% |",
    ]


def test_a_baseline_reads_back(tmp_path: Path) -> None:
    """What is written is read. Without a file there is no baseline."""
    path = tmp_path / "size.csv"
    assert counts.read(path) == ("", Build())
    counts.write(path, "1.0 (abc)", build(LINES))
    assert counts.read(path) == ("1.0 (abc)", build(LINES))


def test_instructions_are_counted() -> None:
    """Labels, comments, continued lines and declarations are not counted."""
    assert wrapper.functions(IR.encode().splitlines(keepends=True)) == [
        ("_RNvNtC4core3fmt5write", 4),
        ("_ZN3std2rt10lang_start28_$u7b$$u7b$closure$u7d$$u7d$17he39bdf0230cb3880E", 1),
    ]


@pytest.mark.parametrize(
    ("symbol", "name"),
    [
        ("_ZN4core3fmt5write17h0123456789abcdefE", "core::fmt::write"),
        ("_ZN3std2rt10lang_start28_$u7b$$u7b$closure$u7d$$u7d$17he39bdf0230cb3880E", "std::rt::lang_start::{{closure}}"),
        ("_ZN45_$LT$a..Vec$LT$T$GT$$u20$as$u20$b..Extend$GT$6extend17h0123456789abcdefE", "<a::Vec<T> as b::Extend>::extend"),
        ("main", None),
    ],
)
def test_symbols_of_the_older_mangling_are_read(symbol: str, name: str | None) -> None:
    """The hash goes, and signs are what they stand for."""
    assert functions.legacy(symbol) == name


@pytest.mark.parametrize(
    ("name", "generic"),
    [
        ("a::f", "a::f"),
        ("a::f::<b::C<d>, e>", "a::f"),
        ("<a::B<c> as d::E<f>>::g", "<a::B as d::E>::g"),
        ("core::ptr::drop_in_place<alloc::vec::Vec<u8>>", "core::ptr::drop_in_place"),
        ("<alloc[fdfd2bd8633a6659]::alloc::Global>::grow", "<alloc::alloc::Global>::grow"),
        ("a::f::<fn(b<c>) -> d>::{closure#0}", "a::f::{closure#0}"),
        ("<dyn a::B<c> as d::E>::g::{{closure}}", "<dyn a::B as d::E>::g::{{closure}}"),
    ],
)
def test_generic_arguments_go(name: str, generic: str) -> None:
    """All instances of a function have one name."""
    assert functions.generic(name) == generic


def test_instances_are_summed() -> None:
    """The largest sum is first."""
    symbols = [(f"_ZN1a{len(name)}{name}17h{at:016x}E", lines) for at, (name, lines) in enumerate([("f", 3), ("g", 5), ("f", 4)])]
    told, *_, row = functions.largest([*symbols, ("_ZN41_$LT$b..C$u20$as$u20$core..fmt..Debug$GT$3fmt17h0123456789abcdefE", 4)], 1)
    assert told == "By the crate in which a function is written: a 75%, b 25%."
    assert row == "| 7 | 43.8% | 2 | `a::f` |"


def test_packages_are_named() -> None:
    """A package has its name in its identity, or the last part of its address."""
    name = counts.package_of
    assert name("registry+https://github.com/rust-lang/crates.io-index#syn@2.0.1") == ("syn", "2.0.1")
    assert name("path+file:///work/crates/cli#featherbench@0.1.0") == ("featherbench", "0.1.0")
    assert name("git+https://example.org/some/thing?rev=12#1.0.0") == ("thing", "1.0.0")


def test_a_library_without_machine_code_is_an_archive() -> None:
    """The member begins after 68 bytes, and the end is even."""
    made = wrapper.archive(b"rust\0")
    assert made[:24] == b"!<arch>\nlib.rmeta/      "
    assert made[66:] == b"`\nrust\0\n"


# a 0–10 alone; b 10–30 with c at 12–20 beside it; d 30–40 on two cores; nothing 40–41; e 41–45, whose linker waits for the disk.
LOG = [
    {"package": "a", "kind": "library", "samples": [[100, 0], [105, 5], [110, 10]]},
    {"package": "b", "kind": "library", "samples": [[110, 0], [130, 20]]},
    {"package": "c", "kind": "library", "samples": [[112, 0], [120, 8]]},
    {"package": "d", "kind": "library", "samples": [[130, 0], [140, 20]]},
    {"package": "e", "kind": "program", "samples": [[141, 0], [145, 1]]},
]


def test_the_times_with_one_busy_core_are_found() -> None:
    """The log above tells who is alone, and the longest stretch of it."""
    calls = times.calls_of(json.dumps(entry | {"wrapper": 0.01}) for entry in LOG)
    divided = times.spans(calls)
    assert sum(span.seconds for span in divided) == 45
    assert times.alone(divided) == {0: 10, 1: 12, 4: 4}
    stretch = times.longest(divided)
    assert (stretch[0].begin, stretch[-1].end) == (100, 112)
    said, _, *table = times.table(calls, 59)
    assert said.startswith("At most one core was busy for 27 s. The longest such stretch took 12 s, after 0 s: a (library) 10 s")
    assert "| b | library | 20.0 | 20.0 | 12.0 | 60% |" in table


def test_a_busy_machine_is_told() -> None:
    """A call that gets half a core disturbs the times. Without other load nothing is said."""
    calls = [times.Call("a", "library", [(0, 0), (10, half)]) for half in (10, 5)]
    assert "Something else used the machine: the compiler got 50% of the cores" in times.table(calls[1:], 5)[0]
    assert "Something else" not in times.table(calls[:1], 10)[0]


def test_a_log_without_calls_has_no_stretch() -> None:
    """Nothing was compiled."""
    assert times.table([], 1.0)[0] == "At most one core was busy for 0 s."


def test_the_measured_command_is_that_of_the_readme() -> None:
    """`test` compiles what README's block tests."""
    asked, readme = times.asked_build, (ROOT / "README.md").read_text()
    assert asked("run", readme) == "cargo build --release"
    assert asked("test", readme) == "cargo test --workspace --no-run"
    with pytest.raises(FailedError, match="is not one command"):
        asked("test", "```sh test\nmake\n```")


def test_a_call_of_cargo_is_told_from_others() -> None:
    """A build script asks the compiler, too."""
    call = ["rustc", "--crate-name", "a", "--edition=2024", "--crate-type", "lib", "--emit=dep-info,metadata,link", "-C", "debuginfo=0"]
    assert wrapper.compiles(call)
    assert wrapper.kind(call) == "library"
    assert wrapper.kind([*call, "--test"]) == "tests"
    assert wrapper.kind(["rustc", "--crate-name", "build_script_build", "--crate-type", "bin"]) == "build script"
    assert not wrapper.compiles(["rustc", "-vV"])
    assert not wrapper.compiles(["rustc", "--crate-name", "probe", "--emit=llvm-ir", "-"])
