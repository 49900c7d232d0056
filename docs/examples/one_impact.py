"""One impact seen closely: the roofs come together, push each other for some milliseconds, and part."""

# %% The study keeps the history of its one scene, ten times a millisecond
import matplotlib.pyplot as plt
import numpy as np

from pounding_cli import run

study = {
    "title": "One impact",
    "records": {"use": ["elcentro"], "duration": "6 s"},
    "buildings": {
        "stiff": {"storeys": 5, "period": "0.36 s"},
        "soft": {"like": "stiff", "period": "0.60 s"},
    },
    "group": ["stiff", "soft"],
    "cases": {"gap": {"link": "pounding", "gap": "2 cm"}},
    "analyses": ["elastic"],
    "keep": {"histories": {"every": "0.1 ms"}},
}
results = run(study, "one_impact.h5")
history = results.history()

# %% The hardest blow between the roofs: where it begins and ends
force = history.link_force[:, -1]
at = int(np.argmax(force))
open_before, open_after = np.flatnonzero(force[:at] == 0).max(), at + np.flatnonzero(force[at:] == 0).min()
time = history.time
lasted = time[open_after] - time[open_before]

# %% What the two roofs did: speeds by differences of their displacements
closing = history.displacement[:, 0, -1] - history.displacement[:, 1, -1]
speed = np.gradient(closing, time)
met, parted = speed[open_before - 1], speed[open_after + 1]
contact = slice(open_before, open_after)
impulse = force[contact].sum() * (time[1] - time[0])
lost = (force * speed)[contact].sum() * (time[1] - time[0])
pull = -force[at:open_after].min() / force[at]
print(f"at {time[at]:.3f} s, for {1000 * lasted:.1f} ms: {force[at] / 1e6:.1f} MN, impulse {impulse / 1e3:.0f} kN s")
print(f"they meet at {met:.2f} m/s and part at {-parted:.2f} m/s; {lost / 1e3:.1f} kJ stay in the dashpot")
print(f"at the end the law of eq. (6) pulls the roofs together with {100 * pull:.0f} % of the largest force")

# %% The figure
around = slice(open_before - 300, open_after + 300)
milliseconds = 1000 * (time[around] - time[open_before])
figure, axes = plt.subplots(3, 1, sharex=True, figsize=(7, 7), layout="constrained")
for place, name in enumerate(history.buildings):
    axes[0].plot(milliseconds, 100 * history.displacement[around, place, -1], label=f"{name}, roof")
    axes[2].plot(milliseconds, history.total_acceleration[around, place, -1] / 9.80665, label=f"{name}, roof")
axes[1].plot(milliseconds, force[around] / 1e6, color="tab:red")
axes[0].set(ylabel="displacement [cm]", title=results.title)
axes[1].set(ylabel="link force [MN]")
axes[2].set(ylabel="acceleration [g]", xlabel="time since the roofs met [ms]")
for ax in axes:
    ax.grid(alpha=0.3)
for ax in (axes[0], axes[2]):
    ax.legend()
figure.savefig("one_impact.png", dpi=110)
