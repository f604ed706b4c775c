"""Two labs in marimo: pip install marimo, then: marimo run marimo_lab.py."""

import marimo

app = marimo.App(width="full")


@app.cell
def _():
    import marimo as mo

    from percept_obs.labs import observer_lab

    return mo, observer_lab


@app.cell
def _(mo):
    mo.md("""
    # A lab in marimo

    Drag the focus of expansion. What stands below the labs follows, because marimo runs each cell again whose values
    have changed.
    """)
    return


@app.cell
def _(mo, observer_lab):
    lab = mo.ui.anywidget(observer_lab())
    lab
    return (lab,)


@app.cell
def _(mo, observer_lab):
    with_one_output = mo.ui.anywidget(observer_lab(outputs=["y1"]))
    with_one_output
    return (with_one_output,)


@app.cell
def _(lab, mo, observer_lab, with_one_output):
    both = {"first": lab, "second": with_one_output}
    runs = {name: observer_lab(**each.value["settings"]).run() for name, each in both.items()}
    mo.md("\n".join(f"- The {name} lab, in Python: {run.verdict()}." for name, each in runs.items() for run in each.values()))
    return


if __name__ == "__main__":
    app.run()
