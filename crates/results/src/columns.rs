//! The one table from which the header, the schema and the documentation of a row are made.

use serde::Serialize;

/// How a column is written.
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
}

/// One column of `records.csv`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Column {
    /// Its name in the header.
    pub name: &'static str,
    /// How it is written.
    #[serde(rename = "type")]
    pub kind: ColumnType,
    /// The unit of its numbers; empty for text, `unit` where the column of that name tells it.
    pub unit: &'static str,
    /// The words it may hold; empty unless it is a [`ColumnType::Word`].
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

/// The columns of `records.csv` in their order; [`Record`](crate::Record) has a field for each, in the same order.
pub const COLUMNS: [Column; 27] = [
    text("run", "id of the run that produced the row"),
    text("cell", "content hash of the unit of work that the row belongs to"),
    text("study", "the question asked: agreement, timing, structure, …"),
    text("problem", "family of the model, or problem of the study: chain, tree, humanoid, …"),
    text("model", "name of the model; empty where a study has none"),
    integer("nq", "coordinates", "length of the configuration vector"),
    integer("nv", "degrees of freedom", "length of the velocity vector"),
    integer("bodies", "bodies", "moving bodies of the model"),
    integer("depth", "joints", "joints on the longest path from the base to a leaf"),
    text("params", "parameters of the cell as canonical JSON: keys sorted, no spaces"),
    text("engine", "who answered: native, pinocchio, mujoco, drake, …"),
    text("engine_version", "the version that the engine itself reports"),
    text("method", "the engine's algorithm, where it offers several"),
    text("scalar", "arithmetic of the answer: f64, f32, …"),
    text("quantity", "what was computed: id, mass_matrix, fd, … or the algorithm that was timed"),
    text("case", "kind of input states: random, zero, straight, fast, limit; for times: stream, hot"),
    text("metric", "measure of the value: scaled, forward, backward, kappa, pairwise, ns_per_call, …"),
    word("kind", &["exact", "measured"], "exact: the same bits on every run; measured: taken on a machine"),
    float("value", "unit", "the result; empty when there is none or it was not finite"),
    text("unit", "unit of value, bound and floor; `ratio` for a pure ratio"),
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
    text("reason", "why the verdict is not pass; empty otherwise"),
];

/// The text of `schema.json`: format, and every column with type, unit, words and meaning.
pub fn schema_json() -> String {
    #[derive(Serialize)]
    struct Schema {
        format: u32,
        file: &'static str,
        columns: &'static [Column],
    }
    let schema = Schema { format: crate::RUN_FORMAT, file: crate::CSV_NAME, columns: &COLUMNS };
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}
