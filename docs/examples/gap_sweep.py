"""How wide must a gap be? A sweep of the gap between two buildings, and one figure."""

# %% The study: the words of a study file, as a dict
import matplotlib.pyplot as plt
import numpy as np

from pounding_cli import run

gaps = np.linspace(0.0, 0.14, 15)
study = {
    "title": "How wide must a gap be?",
    "records": {"use": ["elcentro"], "duration": "10 s"},
    "buildings": {
        "stiff": {"storeys": 5, "period": "0.36 s"},
        "soft": {"like": "stiff", "period": "0.60 s"},
    },
    "group": ["stiff", "soft"],
    "cases": {"gap": {"link": "pounding", "gap": 0.0}},
    "sweep": {"cases.gap.gap": gaps},
}

# %% Run it: what gap_sweep.h5 already holds is not solved again
results = run(study, "gap_sweep.h5")

# %% Tables are pandas frames, swept keys first
roof = results.storey().query("storey == 5")
ratios = roof.pivot_table(index="cases.gap.gap", columns=["analysis", "building"], values="V_ratio")
impacts = results.link().groupby(["cases.gap.gap", "analysis"])["impacts"].sum().unstack()
separation = results.buildings["separation"].dropna().iloc[0]
enough = impacts.index[(impacts["inelastic"] == 0)].min()
print(ratios.round(3))
print(f"the code asks for {100 * separation:.1f} cm; from {100 * enough:.0f} cm on, inelastic, nothing touches")

# %% The figure
figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(7, 6), layout="constrained")
for (analysis, building), line in ratios.items():
    style = "-" if analysis == "elastic" else "--"
    above.plot(100 * line.index, line, style, marker="o", label=f"{building}, {analysis}")
for analysis, line in impacts.items():
    below.plot(100 * line.index, line, "-" if analysis == "elastic" else "--", marker="o", color="0.3", label=analysis)
for ax in (above, below):
    ax.axvline(100 * separation, color="tab:red", lw=1)
    ax.grid(alpha=0.3)
    ax.legend()
above.axhline(1.0, color="0.5", lw=1)
above.set(ylabel="shear of the top storey, V / V0", title=results.title)
below.set(ylabel="impacts, all floors", xlabel="gap [cm]; red: the code's separation")
figure.savefig("gap_sweep.png", dpi=110)
