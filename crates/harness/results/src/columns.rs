//! The one table of columns: the header, the schema and a row's fields with their documentation are made from it.

use serde::{Deserialize, Serialize};

use crate::{Kind, Relation, Verdict};

/// Name of the rows' file in a run's folder.
pub const CSV_NAME: &str = "rows.csv";

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

/// A type of fields: how their texts are read.
trait Field {
    const KIND: ColumnType;
    const WORDS: &'static [&'static str] = &[];
}

impl Field for String {
    const KIND: ColumnType = ColumnType::Text;
}

impl Field for Option<u64> {
    const KIND: ColumnType = ColumnType::Integer;
}

impl Field for Option<f64> {
    const KIND: ColumnType = ColumnType::Float;
}

impl Field for bool {
    const KIND: ColumnType = ColumnType::Flag;
}

impl Field for Kind {
    const KIND: ColumnType = ColumnType::Word;
    const WORDS: &'static [&'static str] = Self::WORDS;
}

impl Field for Option<Relation> {
    const KIND: ColumnType = ColumnType::Word;
    const WORDS: &'static [&'static str] = Relation::WORDS;
}

impl Field for Verdict {
    const KIND: ColumnType = ColumnType::Word;
    const WORDS: &'static [&'static str] = Self::WORDS;
}

/// Makes [`Row`] and [`COLUMNS`]. Each column has its name, its type, the field of an empty row if the type has another default, its unit
/// and what it means.
macro_rules! columns {
    ($($name:ident: $type:ty $(= $empty:expr)? $(, [$unit:literal])?, $description:literal;)+) => {
        /// One result: a field for each of [`COLUMNS`], in the same order.
        ///
        /// Set the fields that identify the row with a struct literal over [`Row::default`]. Then close it with one of
        /// [`gated`](Self::gated), [`informed`](Self::informed) and [`without_value`](Self::without_value). They keep value, margin, verdict
        /// and reason consistent.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        pub struct Row {
            $(#[doc = $description] pub $name: $type),+
        }

        impl Default for Row {
            /// An empty, exact, unjudged row with the parameters `{}`.
            fn default() -> Self {
                Self { $($name: columns!(@empty $($empty)?)),+ }
            }
        }

        /// The columns of `rows.csv` in their order.
        pub const COLUMNS: [Column; [$(stringify!($name)),+].len()] = [$(Column {
            name: stringify!($name),
            kind: <$type as Field>::KIND,
            unit: concat!($($unit)?),
            words: <$type as Field>::WORDS,
            description: $description,
        }),+];
    };
    (@empty) => { Default::default() };
    (@empty $empty:expr) => { $empty };
}

columns! {
    run: String, "id of the run that produced the row";
    cell: String, "content hash of the unit of work that the row belongs to";
    study: String, "the question asked: agreement, timing, operations, …";
    family: String, "family of the robot: chain, tree, humanoid, …";
    robot: String, "name of the robot; empty where a study has none";
    nq: Option<u64>, ["coordinates"], "length of the configuration vector";
    nv: Option<u64>, ["degrees of freedom"], "length of the velocity vector";
    bodies: Option<u64>, ["bodies"], "moving bodies of the robot";
    depth: Option<u64>, ["joints"], "joints on the longest path from the base to a leaf";
    engine: String, "the engine that answered: featherbench (our kernels), pinocchio, mujoco, drake, …";
    engine_version: String, "the version that the engine itself reports";
    method: String, "the engine's way to the quantity, where it offers several";
    precision: String, "arithmetic of the answer: f64, f32, …";
    quantity: String, "what was computed or timed: id, mass_matrix, fd, …";
    states: String, "kind of input states: random, zero, straight, fast, limit, all; empty where there are none";
    body: String, "the body that the row is about; empty where it is the whole robot";
    cache: String, "over what a time was taken: stream (many states in turn), hot (one state again and again); empty for the rest";
    metric: String, "measure of the value: scaled, forward, backward, kappa, pairwise, ns_per_call, …";
    kind: Kind = Kind::Exact, "exact: the same bits on every run; measured: taken on a machine";
    value: Option<f64>, ["unit"], "the result; empty when there is none or it was not finite";
    ci_low: Option<f64>, ["unit"], "lower end of the confidence interval of a measured value, where it has one";
    ci_high: Option<f64>, ["unit"], "upper end of that interval";
    unit: String, "unit of value, interval, bound and floor; `ratio` for a pure ratio";
    reference: String, "with what the value was compared: an engine, a closed form, a data set";
    relation: Option<Relation>, "how value must stand to bound; empty when nothing is judged; within: |value| ≤ bound";
    bound: Option<f64>, ["unit"], "the gate";
    floor: Option<f64>, ["unit"], "least error that the rounding of the inputs makes unavoidable, where it is known";
    margin: Option<f64>, ["decades"], "distance to the gate, positive inside: log10(bound/|value|) for le and within, log10(value/bound) for ge, empty for eq; clamped to ±16";
    verdict: Verdict = Verdict::Info, "what became of the row";
    valid: bool = true, "whether the value counts: false for a measurement that its control or a check rejects";
    estimated: bool, "whether the value is an estimate: the cost of calling the engine was measured with it and subtracted";
    reason: String, "why the verdict is not pass, or the value not valid; for people; empty otherwise";
    params: String = "{}".into(), "what a study adds, as canonical JSON: keys sorted, no spaces; `deviation` is the id of the known deviation that explains the row";
}

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
    let schema = Schema { format: crate::RUN_FORMAT, file: CSV_NAME, columns: &COLUMNS, dictionary };
    let mut text = serde_json::to_string_pretty(&schema).unwrap_or_default();
    text.push('\n');
    text
}
