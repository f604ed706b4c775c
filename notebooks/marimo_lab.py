"""Two labs in marimo.  Get it with: python -m pip install marimo.  Open it with: marimo run marimo_lab.py."""

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
    # Two labs in marimo

    Drag the focus of expansion. What stands below follows, because marimo runs each cell again whose values changed.
    """)


@app.cell
def _(mo, observer_lab):
    both = mo.ui.anywidget(observer_lab())
    one = mo.ui.anywidget(observer_lab(outputs=["y1"]))
    mo.vstack([both, one])
    return both, one


@app.cell
def _(both, mo, observer_lab, one):
    runs = [run for lab in (both, one) for run in observer_lab(**lab.value["settings"]).run().values()]
    mo.md("\n".join(f"- {run.observer.name}, in Python: {run.verdict()}." for run in runs))


if __name__ == "__main__":
    app.run()
