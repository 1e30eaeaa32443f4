//! The one table of columns: the header, the schema and the documentation of a row are made from it.

use serde::Serialize;

/// The type of a column's text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ColumnType {
    /// UTF-8 text; empty where it does not apply.
    Text,
    /// A whole number from zero; may be empty.
    Integer,
    /// A finite number in the shortest decimal that reads back to the same double; may be empty.
    Float,
    /// One of the words listed with the column.
    Word,
    /// `true` or `false`; never empty.
    Flag,
}

/// One column of `rows.csv`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Column {
    /// Its name in the header.
    pub name: &'static str,
    /// Its type.
    #[serde(rename = "type")]
    pub kind: ColumnType,
    /// The unit of its numbers. Empty for text; `unit` if the column of that name has it.
    pub unit: &'static str,
    /// The words that it may have; empty unless it is a [`ColumnType::Word`].
    pub words: &'static [&'static str],
    /// What it means.
    pub description: &'static str,
}

const fn text(name: &'static str, description: &'static str) -> Column {
    Column { name, kind: ColumnType::Text, unit: "", words: &[], description }
}

const fn integer(name: &'static str, unit: &'static str, description: &'static str) -> Column {
    Column { name, kind: ColumnType::Integer, unit, words: &[], description }
}

const fn float(name: &'static str, unit: &'static str, description: &'static str) -> Column {
    Column { name, kind: ColumnType::Float, unit, words: &[], description }
}

const fn word(name: &'static str, words: &'static [&'static str], description: &'static str) -> Column {
    Column { name, kind: ColumnType::Word, unit: "", words, description }
}

const fn flag(name: &'static str, description: &'static str) -> Column {
    Column { name, kind: ColumnType::Flag, unit: "", words: &["true", "false"], description }
}

/// The columns of `rows.csv` in their order; [`Row`](crate::Row) has a field for each, in the same order.
pub const COLUMNS: [Column; 33] = [
    text("run", "id of the run that produced the row"),
    text("cell", "content hash of the unit of work that the row belongs to"),
    text("study", "the question asked: agreement, timing, operations, …"),
    text("family", "family of the robot: chain, tree, humanoid, …"),
    text("robot", "name of the robot; empty where a study has none"),
    integer("nq", "coordinates", "length of the configuration vector"),
    integer("nv", "degrees of freedom", "length of the velocity vector"),
    integer("bodies", "bodies", "moving bodies of the robot"),
    integer("depth", "joints", "joints on the longest path from the base to a leaf"),
    text("engine", "the engine that answered: featherbench (our kernels), pinocchio, mujoco, drake, …"),
    text("engine_version", "the version that the engine itself reports"),
    text("method", "the engine's way to the quantity, where it offers several"),
    text("precision", "arithmetic of the answer: f64, f32, …"),
    text("quantity", "what was computed or timed: id, mass_matrix, fd, …"),
    text("states", "kind of input states: random, zero, straight, fast, limit, all; empty where there are none"),
    text("body", "the body that the row is about; empty where it is the whole robot"),
    text("cache", "over what a time was taken: stream (many states in turn), hot (one state again and again); empty for the rest"),
    text("metric", "measure of the value: scaled, forward, backward, kappa, pairwise, ns_per_call, …"),
    word("kind", &["exact", "measured"], "exact: the same bits on every run; measured: taken on a machine"),
    float("value", "unit", "the result; empty when there is none or it was not finite"),
    float("ci_low", "unit", "lower end of the confidence interval of a measured value, where it has one"),
    float("ci_high", "unit", "upper end of that interval"),
    text("unit", "unit of value, interval, bound and floor; `ratio` for a pure ratio"),
    text("reference", "with what the value was compared: an engine, a closed form, a data set"),
    word("relation", &["le", "ge", "eq", "within"], "how value must stand to bound; empty when nothing is judged; within: |value| ≤ bound"),
    float("bound", "unit", "the gate"),
    float("floor", "unit", "least error that the rounding of the inputs makes unavoidable, where it is known"),
    float(
        "margin",
        "decades",
        "distance to the gate, positive inside: log10(bound/|value|) for le and within, log10(value/bound) for ge, empty for eq; clamped to ±16",
    ),
    word("verdict", &["pass", "fail", "info", "skip", "error", "deviation"], "what became of the row"),
    flag("valid", "whether the value counts: false for a measurement that its control or a check rejects"),
    flag("estimated", "whether the value is an estimate: the cost of calling the engine was measured with it and subtracted"),
    text("reason", "why the verdict is not pass, or the value not valid; for people; empty otherwise"),
    text(
        "params",
        "what a study adds, as canonical JSON: keys sorted, no spaces; `deviation` is the id of the known deviation that explains the row",
    ),
];

/// The text of `schema.json`: format, every column with type, unit, words and meaning, and the meaning of the names in rows.
pub fn schema_json(dictionary: &crate::Dictionary) -> String {
    #[derive(Serialize)]
    struct Schema<'a> {
        format: u32,
        file: &'static str,
        columns: &'static [Column],
        #[serde(flatten)]
        dictionary: &'a crate::Dictionary,
    }
    let schema = Schema { format: crate::RUN_FORMAT, file: crate::CSV_NAME, columns: &COLUMNS, dictionary };
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}
