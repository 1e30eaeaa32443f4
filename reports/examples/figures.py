"""Two of the report's figures, made from rows in Parquet by DuckDB and by polars.

    featherbench export reports/RUN --parquet rows
    python reports/examples/figures.py rows figures

The first is a map of the largest error of each engine and quantity, the second shows the error against the robot's depth. Both are SVG.
``ci/python-tools`` installs what this needs.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import duckdb
import matplotlib as mpl
import pandas as pd
import polars as pl

mpl.use("svg")
import matplotlib.pyplot as plt

#: An error of exactly zero is drawn at this value, below the unit roundoff of double precision.
ZERO = 1e-17


def worst(files: str) -> list[tuple[str, str, float]]:
    """Engine, quantity and largest error of the study `agreement`, by DuckDB."""
    query = """
        SELECT engine, quantity, max(value) FROM read_parquet(?, hive_partitioning = true)
        WHERE study = 'agreement' AND metric = 'scaled' AND value IS NOT NULL GROUP BY ALL ORDER BY ALL
    """
    return duckdb.execute(query, [files]).fetchall()


def by_depth(files: str) -> pl.DataFrame:
    """Depth, engine and largest error of inverse dynamics there, by polars."""
    rows = pl.scan_parquet(files, hive_partitioning=True)
    mine = rows.filter((pl.col("study") == "agreement") & (pl.col("metric") == "scaled") & (pl.col("quantity") == "id"))
    return mine.drop_nulls("value").group_by("engine", "depth").agg(pl.col("value").max()).sort("engine", "depth").collect()


#: The names of one type in polars, pandas (with the types of Arrow) and DuckDB.
TYPES = {
    ("String", "string", "VARCHAR"),
    ("Int64", "int64", "BIGINT"),
    ("Float64", "double", "DOUBLE"),
    ("Boolean", "bool", "BOOLEAN"),
}
#: Some columns with their types in `schema.json`, in the words of polars.
DUE = {"study": "String", "engine": "String", "nv": "Int64", "value": "Float64", "margin": "Float64", "valid": "Boolean"}


def check(folder: Path, files: str) -> tuple[int, int, int]:
    """Number of rows by polars, pandas and DuckDB; an error if a column has another type in one of them, or than `schema.json` says."""
    lazy = pl.scan_parquet(files, hive_partitioning=True)
    by_polars = {name: str(kind) for name, kind in lazy.collect_schema().items()}
    frame = pd.read_parquet(folder, dtype_backend="pyarrow")
    # pandas makes categories of what is in the names of folders.
    frame["study"] = frame["study"].astype("string[pyarrow]")
    by_pandas = {name: str(kind).removesuffix("[pyarrow]") for name, kind in frame.dtypes.items()}
    described = duckdb.execute("DESCRIBE SELECT * FROM read_parquet(?, hive_partitioning = true)", [files]).fetchall()
    by_duckdb = {column[0]: column[1] for column in described}
    if not set(by_polars) == set(by_pandas) == set(by_duckdb):
        message = f"{folder}: the columns differ: {sorted(by_polars)}, {sorted(by_pandas)}, {sorted(by_duckdb)}"
        raise TypeError(message)
    for name, kind in by_polars.items():
        kinds = (kind, by_pandas[name], by_duckdb[name])
        if kinds not in TYPES or kind != DUE.get(name, kind):
            message = f"{folder}: the column {name} is {kinds[0]} in polars, {kinds[1]} in pandas and {kinds[2]} in DuckDB"
            raise TypeError(message)
    counted = duckdb.execute("SELECT count(*) FROM read_parquet(?, hive_partitioning = true)", [files]).fetchall()[0][0]
    return lazy.select(pl.len()).collect().item(), len(frame), counted


def draw_map(cells: list[tuple[str, str, float]], path: Path) -> None:
    """Draws the map of errors."""
    engines, quantities = sorted({cell[0] for cell in cells}), sorted({cell[1] for cell in cells})
    grid = [[math.nan] * len(quantities) for _ in engines]
    for engine, quantity, value in cells:
        grid[engines.index(engine)][quantities.index(quantity)] = math.log10(max(value, ZERO))
    figure, axes = plt.subplots(figsize=(10, 4), layout="constrained")
    image = axes.imshow(grid, aspect="auto", cmap="viridis")
    axes.set_yticks(range(len(engines)), engines)
    axes.set_xticks(range(len(quantities)), quantities, rotation=60, ha="right")
    figure.colorbar(image, label="log₁₀ of the largest error")
    figure.savefig(path)


def draw_depth(table: pl.DataFrame, path: Path) -> None:
    """Draws the error against the depth."""
    figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
    for (engine,), rows in table.group_by("engine", maintain_order=True):
        axes.loglog(rows["depth"], rows["value"].clip(lower_bound=ZERO), "o-", label=str(engine))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter("{x:g}")
    axes.set_xlabel("depth in joints")
    axes.set_ylabel("largest error of inverse dynamics")
    axes.legend()
    figure.savefig(path)


def main() -> None:
    """Reads the rows and draws both figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rows", type=Path, help="the folder that `featherbench export --parquet` wrote")
    parser.add_argument("out", type=Path, help="the folder of the figures")
    arguments = parser.parse_args()
    files = f"{arguments.rows}/**/*.parquet"
    cells, table, counts = worst(files), by_depth(files), check(arguments.rows, files)
    if not cells or table.is_empty():
        parser.error(f"{arguments.rows} has no errors of the study agreement")
    arguments.out.mkdir(parents=True, exist_ok=True)
    draw_map(cells, arguments.out / "map.svg")
    draw_depth(table, arguments.out / "depth.svg")
    by_polars, by_pandas, by_duckdb = counts
    rows = f"{by_polars} rows by polars, {by_pandas} by pandas, {by_duckdb} by DuckDB"
    print(f"{rows}, {len(cells)} pairs of engine and quantity, {table.height} depths")


if __name__ == "__main__":
    main()
