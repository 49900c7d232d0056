"""The faults: what is wrong in words, the text that makes it so, and the test that has to see it.

Texts are short and stand once in their file; a fault whose text is gone is an error, to be rewritten with the code."""

from __future__ import annotations

from .runner import Mutant

KERNELS, MODEL, RECORDS = "pounding_cli/kernels", "pounding_cli/model", "pounding_cli/records"
SOLVE, WALL, STORE = "pounding_cli/solve", "pounding_cli/wall", "pounding_cli/store"
VERIFICATION, UNIT = "tests/verification", "tests/unit"

IMPACT = f"{VERIFICATION}/test_impact.py::test_printed_law"
WITHIN = f"{VERIFICATION}/test_impact.py::test_a_blow_within_one_step_of_the_motion"
TENSION = f"{VERIFICATION}/test_impact.py::test_tension_cut"
INFILL = f"{VERIFICATION}/test_infill.py::test_peak_compression_of_an_undamped_infill"
INFILL_DAMPED = f"{VERIFICATION}/test_infill.py::test_damped_infill_against_the_reference"
INFILL_CUT = f"{VERIFICATION}/test_infill.py::test_an_infill_that_cannot_pull_presses_again_in_time"
CONNECTED = f"{VERIFICATION}/test_connected_pair.py::test_two_free_masses_on_a_connector"
THROW = f"{VERIFICATION}/test_hysteresis.py::test_throw_of_an_undamped_storey"
EVENTS = f"{VERIFICATION}/test_event_reference.py::test_pounding"
YIELDING = f"{VERIFICATION}/test_event_reference.py::test_yielding_connected_pair_with_a_tail"
LINEAR = f"{VERIFICATION}/test_linear_vibration.py"
FOUNDED = f"{VERIFICATION}/test_foundation.py::test_shaken_building_against_exact_stepping"
ENERGIES = f"{VERIFICATION}/test_energy.py"
ORDERS = f"{VERIFICATION}/test_methods.py::test_declared_order_where_nothing_jumps"
ARIAS = f"{UNIT}/records/test_intensity.py::test_arias_of_a_triangle_is_exact"
SCALING = f"{UNIT}/records/test_scaling.py::test_arias_factor_reaches_the_target_motion"
CODE = f"{UNIT}/model/test_code_design.py"
STIFFNESS = f"{UNIT}/model/test_stiffness.py"

LINKS = [
    Mutant(
        "eq. (7) with m' upside-down, as printed",
        f"{MODEL}/links.py",
        "return reduced if self.dashpot_law is DashpotLaw.REDUCED_MASS else 1.0 / reduced",
        "return 1.0 / reduced if self.dashpot_law is DashpotLaw.REDUCED_MASS else reduced",
        IMPACT,
    ),
    Mutant(
        "m' is the sum of the masses' half",
        f"{MODEL}/links.py",
        "reduced = left_mass * right_mass / (left_mass + right_mass)",
        "reduced = 0.25 * (left_mass + right_mass)",
        IMPACT,
    ),
    Mutant(
        "dashpot without its factor 2",
        f"{MODEL}/links.py",
        "return 2 * self.damping_ratio * math.sqrt(self.stiffness",
        "return self.damping_ratio * math.sqrt(self.stiffness",
        IMPACT,
    ),
    Mutant(
        "xi = -ln e / pi, without ln e under the root",
        f"{MODEL}/links.py",
        "return -log / math.hypot(math.pi, log)",
        "return -log / math.pi",
        IMPACT,
    ),
    Mutant(
        "tension dropped where the law as printed keeps it",
        f"{SOLVE}/arrays.py",
        "int(link.tension_cut and link.damping_ratio > 0",
        "int(link.damping_ratio > 0",
        IMPACT,
    ),
    Mutant(
        "tension kept where it should be cut",
        f"{KERNELS}/crossings.py",
        "if run.ties[of_tie(e, c.CUTS)] == 1",
        "if run.ties[of_tie(e, c.CUTS)] == 2",
        TENSION,
    ),
    Mutant(
        "gap added instead of subtracted when looking for contact",
        f"{KERNELS}/link_series.py",
        "= gap if kind == POUNDING",
        "= -gap if kind == POUNDING",
        IMPACT,
    ),
    Mutant(
        "contact begins at the end of the step",
        f"{KERNELS}/crossings.py",
        "return first_crossing(run.scratch, run.tally[ORDER], end)",
        "return 1.0 if first_crossing(run.scratch, run.tally[ORDER], end) <= end else NEVER",
        IMPACT,
    ),
    Mutant(
        "a closing that turns within the step is taken as monotone",
        f"{KERNELS}/crossings.py",
        "stays |= ~bends(first, last, stray) & began",
        "stays |= began",
        WITHIN,
    ),
    Mutant(
        "a step at the pace of the one before passes for the rest of the segment",
        f"{KERNELS}/taylor.py",
        "    whole = h <= run.clock[PACE]\n    if not whole:",
        "    whole = True\n    if h > run.clock[PACE]:",
        EVENTS,
    ),
    Mutant(
        "contact pushes the right floor with half the force",
        f"{KERNELS}/link_series.py",
        "total = total + gain",
        "total = total + 0.5 * gain",
        IMPACT,
    ),
    Mutant(
        "contact does not push the left floor",
        f"{KERNELS}/link_series.py",
        "- gather(run.pushed",
        "- 0.0 * gather(run.pushed",
        IMPACT,
    ),
    Mutant(
        "impulse without the length of the step",
        f"{KERNELS}/peaks.py",
        "fused(impulse, held,",
        "fused(impulse, applied,",
        IMPACT,
    ),
    Mutant(
        "infill's cubic without the 3 in 3 d^2",
        f"{SOLVE}/arrays.py",
        "(link.impact_stiffness - link.stiffness) / (3 * link.gap**2)",
        "(link.impact_stiffness - link.stiffness) / link.gap**2",
        INFILL,
    ),
    Mutant(
        "infill jumps at v = d, as eq. (9) is printed",
        f"{SOLVE}/arrays.py",
        "if link.infill_law is InfillLaw.CONTINUOUS:",
        "if link.infill_law is InfillLaw.PRINTED:",
        INFILL,
    ),
    Mutant(
        "infill's dashpot with the left mass instead of m'",
        f"{SOLVE}/arrays.py",
        "2 * link.damping_ratio * np.sqrt(mass)",
        "2 * link.damping_ratio * np.sqrt(left_mass)",
        INFILL_DAMPED,
    ),
    Mutant(
        "infill's dashpot keeps the slope at v = 0",
        f"{KERNELS}/link_series.py",
        "root = (3.0 * cubic * square - roots) * load(links, at_link(b, c.HALF))",
        "root = 0.0 * roots",
        INFILL_DAMPED,
    ),
    Mutant(
        "infill never stiffens at v = d",
        f"{KERNELS}/crossings.py",
        "event = STIFFENS if cubic else SOFTENS",
        "event = SOFTENS",
        INFILL,
    ),
    Mutant(
        "connector holds in compression only",
        f"{SOLVE}/arrays.py",
        "kind == layout.CONNECTOR, layout.LINEAR, layout.OPEN",
        "kind == layout.CONNECTOR, layout.OPEN, layout.OPEN",
        YIELDING,
    ),
]

STOREYS = [
    Mutant(
        "unloading with the hardened stiffness",
        f"{KERNELS}/branching.py",
        "slots[of(i, c.TANGENT)] = k0\n",
        "slots[of(i, c.TANGENT)] = a * k0\n",
        THROW,
    ),
    Mutant(
        "isotropic instead of kinematic hardening",
        f"{KERNELS}/branching.py",
        "slots[of(i, c.PLASTIC)] = drift - line * slots[of(i, c.YIELD_DRIFT)]\n",
        "slots[of(i, c.PLASTIC)] = drift - line * slots[of(i, c.YIELD_DRIFT)]\n"
        "        slots[of(i, c.YIELD_DRIFT)] *= 1.0 + slots[of(i, c.HARDENING)]\n"
        "        slots[of(i, c.PLATEAU)] *= 1.0 + slots[of(i, c.HARDENING)]\n",
        THROW,
    ),
    Mutant(
        "post-yield line starts at Vy instead of (1 - a) Vy",
        f"{SOLVE}/arrays.py",
        "plateau = (1 - building.hardening) * np.where",
        "plateau = np.where",
        THROW,
    ),
    Mutant(
        "no yielding on the lower line",
        f"{KERNELS}/crossings.py",
        "for line in (1.0, -1.0):",
        "for line in (1.0, 1.0):",
        THROW,
    ),
    Mutant(
        "yielding and unloading at the end of the step",
        f"{KERNELS}/crossings.py",
        "            slots[of(i, c.ROOT)] = s\n",
        "            s = 1.0 if s <= 1.0 else s\n            slots[of(i, c.ROOT)] = s\n",
        THROW,
    ),
    Mutant(
        "inelastic runs stay elastic",
        f"{MODEL}/effects.py",
        "        inelastic and can_yield,\n",
        "        inelastic and not can_yield,\n",
        THROW,
    ),
    Mutant(
        "Rayleigh's beta on the tangent stiffness",
        f"{KERNELS}/recurrence.py",
        "-(dashpot + above_dashpot)",
        "-(dashpot * below / max(slots[of(i, c.STIFFNESS)], 1.0) + above_dashpot)",
        YIELDING,
    ),
]

MOTION = [
    Mutant(
        "ground input missing on one floor",
        f"{SOLVE}/arrays.py",
        "slots.real[:place] = 1.0",
        "slots.real[1:place] = 1.0",
        f"{LINEAR}::test_five_storeys_against_exact_stepping",
    ),
    Mutant(
        "storey above pulls the floor the wrong way",
        f"{KERNELS}/recurrence.py",
        "slots[of(i, c.RIGHT)] = above * inverse",
        "slots[of(i, c.RIGHT)] = -above * inverse",
        f"{LINEAR}::test_five_storeys_against_exact_stepping",
    ),
    Mutant(
        "neighbours that may meet are left apart",
        f"{KERNELS}/islands.py",
        "        found |= _closes(run, e, rise - beside(run, run.ends, 3 * run.padded, e, c.RIGHT_SLOT))",
        "        found |= 0 * _closes(run, e, rise)",
        f"{VERIFICATION}/test_islands.py::test_islands_equal_the_row",
    ),
    Mutant(
        "an island solved again begins with the velocities it ended with",
        f"{KERNELS}/islands.py",
        "        store(run.W, b, load(rows, run.padded + b))",
        "        store(run.W, b, load(run.W, b))",
        f"{VERIFICATION}/test_islands.py::test_islands_equal_the_row",
    ),
    Mutant(
        "an island solved again keeps the energies of what was taken back",
        f"{KERNELS}/cells.py",
        "SLOT_LEFT, SLOT_LEFT_END = LINE, FORCE",
        "SLOT_LEFT, SLOT_LEFT_END = LINE, INPUT",
        f"{VERIFICATION}/test_islands.py::test_islands_equal_the_row",
    ),
    Mutant(
        "an island solved again keeps the stencils of what was taken back",
        f"{KERNELS}/islands.py",
        "        restencil(run, i)\n",
        "",
        f"{VERIFICATION}/test_islands.py::test_islands_equal_the_row",
    ),
    Mutant(
        "an island solved again keeps the impacts of what was taken back",
        f"{KERNELS}/cells.py",
        "TIE_LEFT, TIE_LEFT_END = BRANCH, 8 * _TIE",
        "TIE_LEFT, TIE_LEFT_END = BRANCH, IMPACTS",
        f"{VERIFICATION}/test_islands.py::test_islands_equal_the_row",
    ),
    Mutant(
        "a floor of a building alone does not feel the velocity of the one below",
        f"{KERNELS}/recurrence.py",
        "        w_left, w_right = from_left(zero, w), from_right(w, zero)",
        "        w_left, w_right = zero, from_right(w, zero)",
        f"{LINEAR}::test_five_storeys_against_exact_stepping",
    ),
    Mutant(
        "an event anywhere ends the step of the whole row",
        f"{SOLVE}/taylor.py",
        "    apart = not everything and _stand_alone(row, feet)",
        "    apart = everything and _stand_alone(row, feet)",
        f"{VERIFICATION}/test_islands.py::test_what_stands_apart_takes_its_own_steps_two_by_two",
    ),
    Mutant(
        "links that join like places push the wrong way",
        f"{KERNELS}/recurrence.py",
        "            total_right = fused(load(slots, at(b, c.INVERSE_MASS)), pushed, total_right)",
        "            total_right = fused(load(slots, at(b, c.INVERSE_MASS)) * 0.999999, pushed, total_right)",
        f"{VERIFICATION}/test_event_reference.py::test_five_storeys",
    ),
    Mutant(
        "ground acceleration held between samples",
        f"{KERNELS}/recurrence.py",
        "total = total - load(slots, at(b, c.REAL)) * ground",
        "total = total - load(slots, at(b, c.REAL)) * (ground if k == 0 else splat(0.0))",
        f"{LINEAR}::test_forced_vibration_under_straight_lines",
    ),
    Mutant(
        "the motion's last slope goes on in the tail",
        f"{SOLVE}/ground.py",
        "np.concatenate((slopes, still))",
        "np.concatenate((slopes, still + slopes[-1]))",
        f"{LINEAR}::test_a_tail_is_free_vibration",
    ),
    Mutant(
        "mass-proportional damping left out",
        f"{SOLVE}/arrays.py",
        "slots.alpha[span] = building.alpha",
        "slots.alpha[span] = 0.0",
        f"{LINEAR}::test_free_vibration",
    ),
    Mutant(
        "stiffness-proportional damping doubled",
        f"{SOLVE}/arrays.py",
        "slots.dashpot[span] = building.beta * building.stiffness",
        "slots.dashpot[span] = 2 * building.beta * building.stiffness",
        f"{LINEAR}::test_free_vibration",
    ),
    Mutant(
        "a root search that gives up says never",
        f"{KERNELS}/polynomial.py",
        "return _bracketed(c, first, n, s, end, p, last) if last <= 0.0 else s",
        "return NEVER",
        f"{UNIT}/kernels/test_polynomial.py::test_a_root_of_several_in_one_is_found",
    ),
    Mutant(
        "a root search that gives up says that it has arrived",
        f"{KERNELS}/polynomial.py",
        "return _bracketed(c, first, n, s, end, p, last) if last <= 0.0 else s",
        "return s",
        f"{UNIT}/kernels/test_polynomial.py::test_a_root_of_several_in_one_is_found",
    ),
    Mutant(
        "peaks at the ends of steps only",
        f"{KERNELS}/polynomial.py",
        "if n < 2 or end <= 0.0:",
        "if n < 200 or end <= 0.0:",
        f"{LINEAR}::test_free_vibration",
    ),
    Mutant(
        "series cut off seven digits too early",
        f"{KERNELS}/recurrence.py",
        "load(slots, at(b, c.SCALE)), quiet) * tolerance",
        "load(slots, at(b, c.SCALE)), quiet) * (1e7 * tolerance)",
        f"{LINEAR}::test_free_vibration",
    ),
    Mutant(
        "series end before a force that is cut off has converged",
        f"{KERNELS}/recurrence.py",
        "        if cut != 0 and _largest_cut_term(run, k) > 1.0:",
        "        if cut != 0 and _largest_cut_term(run, k) > 1e300:",
        INFILL_CUT,
    ),
    Mutant(
        "steps are not shortened for a force that is cut off",
        f"{KERNELS}/recurrence.py",
        "            size = max(size, _largest_cut_term(run, k - 1))",
        "            size = max(size, 1e-300 * _largest_cut_term(run, k - 1))",
        INFILL_CUT,
    ),
    Mutant(
        "floor acceleration relative to the ground",
        f"{KERNELS}/summary.py",
        "ground_end = ground + splat(run.clock[CHANGE])",
        "ground_end = splat(0.0)",
        f"{LINEAR}::test_peaks_under_a_single_ramp",
    ),
    Mutant(
        "storey shears turn the foundation the wrong way",
        f"{KERNELS}/foundations.py",
        "moment += drag * arm + shear * rise",
        "moment += drag * arm - shear * rise",
        FOUNDED,
    ),
    Mutant(
        "structural damping has no reaction on the base",
        f"{KERNELS}/foundations.py",
        "slots[of(base, c.FORCE)] += drag",
        "slots[of(base, c.FORCE)] += 0.0",
        FOUNDED,
    ),
]

ENERGY = [
    Mutant(
        "input of the ground with the wrong sign",
        f"{KERNELS}/ledger.py",
        "load(slots, at(b, c.INPUT)) - mass * pushed",
        "load(slots, at(b, c.INPUT)) + mass * pushed",
        f"{ENERGIES}::test_work_of_the_ground",
    ),
    Mutant(
        "hysteresis of the whole plateau Vy",
        f"{KERNELS}/ledger.py",
        "load(slots, at(b, c.PLATEAU)) * moved",
        "(load(slots, at(b, c.STIFFNESS)) * load(slots, at(b, c.YIELD_DRIFT))) * moved",
        THROW,
    ),
    Mutant(
        "energy stored in links counted twice",
        f"{SOLVE}/energy.py",
        'work_on_links - now["links_stored"]',
        'work_on_links + now["links_stored"]',
        f"{ENERGIES}::test_connector_dashpot_and_spring",
    ),
]

METHODS = [
    Mutant(
        "RK4: a stage counted with 1.9 instead of 2",
        f"{KERNELS}/runge_kutta.py",
        "h / 6.0 * (p.a[i] + 2.0 * (q2.a[i] + q3.a[i]) + q4.a[i])",
        "h / 6.0 * (p.a[i] + 1.9 * q2.a[i] + 2.0 * q3.a[i] + q4.a[i])",
        f"{ORDERS}[rk4]",
    ),
    Mutant(
        "central difference: velocity of the half step taken for the step's",
        f"{KERNELS}/central_difference.py",
        "state.v[i] = 1.5 * half[i] - 0.5 * before[i]",
        "state.v[i] = half[i]",
        f"{ORDERS}[central-difference]",
    ),
    Mutant(
        "Newmark with gamma = 0.52",
        f"{SOLVE}/generalized_alpha.py",
        "gamma = 0.5 - alpha_m + alpha_f",
        "gamma = 0.52 - alpha_m + alpha_f",
        f"{ORDERS}[newmark]",
    ),
    Mutant(
        "estimated error of the finer run instead of the response's",
        f"{SOLVE}/assess.py",
        "error, sensitivity = difference(response, second)",
        "error, sensitivity = difference(second, second)",
        f"{UNIT}/solve/test_assess.py::test_the_error_is_that_of_the_response_and_not_of_the_finer_run",
    ),
    Mutant(
        "drifts at the end are outside the estimated error",
        f"{SOLVE}/assess.py",
        "            (a.residual_drift, b.residual_drift, a.drift),\n",
        "",
        f"{UNIT}/solve/test_assess.py::test_every_column_is_covered",
    ),
    Mutant(
        "a response that misses the accuracy asked is kept",
        f"{SOLVE}/assess.py",
        "        response = second\n        seconds",
        "        seconds",
        f"{UNIT}/solve/test_assess.py::test_a_response_that_misses_the_accuracy_gives_way_to_the_finer_run",
    ),
]

DESIGN = [
    Mutant(
        "UBC 1991: C = 1.2 S / T^(2/3)",
        f"{MODEL}/code_design.py",
        "1.25 * self.soil",
        "1.2 * self.soil",
        f"{CODE}::test_base_shear_coefficient",
    ),
    Mutant(
        "UBC 1985: C S not bounded",
        f"{MODEL}/code_design.py",
        "min(c * self.soil, 0.14)",
        "c * self.soil",
        f"{CODE}::test_base_shear_coefficient",
    ),
    Mutant(
        "F_t at the roof omitted",
        f"{MODEL}/code_design.py",
        "if period > 0.7",
        "if period > 70",
        f"{CODE}::test_top_force",
    ),
    Mutant(
        "separation with 3 Rw / 4",
        f"{MODEL}/code_design.py",
        "3 * self.rw / 8",
        "3 * self.rw / 4",
        f"{CODE}::test_separation_of_the_paper_s_pair",
    ),
    Mutant(
        "storey shears summed from the ground up",
        f"{MODEL}/code_design.py",
        "np.cumsum(forces[::-1])[::-1]",
        "np.cumsum(forces)",
        f"{CODE}::test_storey_shears_below_the_top_force_s_period",
    ),
    Mutant(
        "taper reversed: stiff at the top",
        f"{MODEL}/stiffness.py",
        "np.linspace(1.0, ratio, m.size)",
        "np.linspace(ratio, 1.0, m.size)",
        f"{STIFFNESS}::test_the_period_asked_for_is_the_period_found",
    ),
    Mutant(
        "Rayleigh factors of the first mode alone",
        f"{MODEL}/stiffness.py",
        "w[0], w[min(1, w.size - 1)]",
        "w[0], w[0]",
        f"{STIFFNESS}::test_rayleigh_damping_of_the_first_two_modes",
    ),
]

GROUND = [
    Mutant(
        "Arias intensity with g squared",
        f"{RECORDS}/intensity.py",
        "np.pi / (2.0 * GRAVITY) * np.cumsum(steps)",
        "np.pi / (2.0 * GRAVITY**2) * np.cumsum(steps)",
        ARIAS,
    ),
    Mutant(
        "Arias intensity by the trapezoid of squares",
        f"{RECORDS}/intensity.py",
        "a[:-1] ** 2 + a[:-1] * a[1:] + a[1:] ** 2",
        "1.5 * a[:-1] ** 2 + 1.5 * a[1:] ** 2",
        ARIAS,
    ),
    Mutant(
        "scaling by the peak instead of the Arias intensity",
        f"{RECORDS}/scaling.py",
        "wanted = arias(target) if isinstance(target, Motion)",
        "wanted = arias(motion) * (target.pga / motion.pga) ** 2 if isinstance(target, Motion)",
        SCALING,
    ),
    Mutant(
        "scale factor without the square root",
        f"{RECORDS}/scaling.py",
        'return math.sqrt(_positive(wanted, "Arias intensity to reach", "m/s")',
        'return (_positive(wanted, "Arias intensity to reach", "m/s")',
        SCALING,
    ),
]

OTHERS = [
    Mutant(
        "Fig. 5: determinant with the wrong sign",
        "pounding_cli/connector/oscillators.py",
        "d1 * d2 + z * (d1 + d2)",
        "d1 * d2 - z * (d1 + d2)",
        f"{UNIT}/connector/test_oscillators.py::test_ratios_against_a_linear_solver",
    ),
    Mutant(
        "wall: von Mises without the 3 before the shear",
        f"{WALL}/stress.py",
        "sy**2 + 3 * t**2",
        "sy**2 + t**2",
        f"{UNIT}/wall/test_stress.py::test_von_mises",
    ),
    Mutant(
        "wall: (1 - nu) instead of (1 - nu^2)",
        f"{WALL}/assembly.py",
        "concrete.young / (1 - nu**2)",
        "concrete.young / (1 - nu)",
        f"{UNIT}/wall/test_assembly.py::test_wall_stiffness_against_the_librarys_elasticity",
    ),
    Mutant(
        "wall: the striker is glued to the wall",
        f"{WALL}/transient.py",
        "force = max(force, 0.0)",
        "force = force + 0.0",
        f"{UNIT}/wall/test_transient.py::test_unilateral_force_never_pulls_and_the_gap_never_closes_through",
    ),
    Mutant(
        "frame: bending stiffness 6 EI / L^3",
        f"{WALL}/frame.py",
        "(3, 12)",
        "(3, 6)",
        f"{UNIT}/wall/test_frame.py::test_cantilever",
    ),
    Mutant(
        "tables: deviation over n instead of n - 1",
        f"{STORE}/statistics.py",
        "sum(axis=axis), count - 1)",
        "sum(axis=axis), count)",
        "tests/peers/test_record_statistics.py::test_against_pandas",
    ),
    Mutant(
        "tables: V0 / V instead of V / V0",
        f"{STORE}/statistics.py",
        "np.divide(value, alone,",
        "np.divide(alone, value,",
        f"{UNIT}/store/test_store_results.py::test_storey_table_has_one_row_per_storey_that_exists",
    ),
]

EXACT = f"{VERIFICATION}/test_effects.py::test_exact_steps_equal_the_series"
OPEN_GAP = f"{VERIFICATION}/test_effects.py::test_a_gap_is_only_called_open_when_it_is"
APART = f"{VERIFICATION}/test_effects.py::test_a_row_falls_apart_where_nothing_closes"
RIGID = f"{VERIFICATION}/test_effects.py::test_rigid_foundation_is_held_fixed"

PRUNING = [
    Mutant(
        "exact steps: accelerations without the ground's",
        f"{SOLVE}/exponential.py",
        "acceleration[:, -2] += 1.0",
        "acceleration[:, -2] += 0.0",
        EXACT,
    ),
    Mutant(
        "exact steps: energy of a sample by a series with k instead of k + 1",
        f"{SOLVE}/exponential.py",
        "term = (product + product.T) / (j + 1)",
        "term = (product + product.T) / j",
        EXACT,
    ),
    Mutant(
        "exact steps: the ground's work with the wrong sign",
        f"{SOLVE}/exponential.py",
        "powers_at[0, count:-2, -2] = -system.loaded",
        "powers_at[0, count:-2, -2] = system.loaded",
        EXACT,
    ),
    Mutant(
        "exact steps: peaks only at the ends of steps",
        f"{KERNELS}/exponential.py",
        "tops_out = turns & greater(above + stray, up)",
        "tops_out = turns & greater(above - stray, up)",
        EXACT,
    ),
    Mutant(
        "exact steps: a step counts as monotone too soon",
        f"{KERNELS}/exponential.py",
        "turns = greater(stray * 4.0, above - below)",
        "turns = greater(stray * 0.5, above - below)",
        f"{VERIFICATION}/test_effects.py::test_exact_steps_find_peaks_between_spikes",
    ),
    Mutant(
        "a gap counts as open if it is nearly as wide as the largest closing",
        f"{SOLVE}/groups.py",
        "closings[link] + error >= link.gap",
        "closings[link] + error >= 1.01 * link.gap",
        OPEN_GAP,
    ),
    Mutant(
        "a link between groups has no closing",
        f"{SOLVE}/groups.py",
        "(0, 0.0, closing, 0.0, 0.0)",
        "(0, 0.0, 0.0 * closing, 0.0, 0.0)",
        APART,
    ),
    Mutant(
        "a rigid foundation is judged without the building's height",
        f"{MODEL}/condense.py",
        "share(stiffest * tall**2, foundation.inertia",
        "share(stiffest, foundation.inertia",
        RIGID,
    ),
    Mutant(
        "elastic storeys yield when the kernel could let them",
        f"{SOLVE}/arrays.py",
        "if analysis == Analysis.INELASTIC:",
        "if analysis in (Analysis.INELASTIC, Analysis.ELASTIC):",
        f"{VERIFICATION}/test_effects.py::test_looking_for_yielding_changes_nothing_in_an_elastic_scene",
    ),
    Mutant(
        "tables: the error of a mean is the sum of its records'",
        f"{STORE}/statistics.py",
        "known.sum(axis=axis) if name",
        "1 + 0 * known.sum(axis=axis) if name",
        f"{UNIT}/store/test_store_trust.py::test_errors_add_up_and_sensitivities_are_weighted",
    ),
]

HISTORIES = [
    Mutant(
        "a run that goes on forgets its plastic drifts",
        f"{KERNELS}/branching.py",
        "        _storey_branch(run, i)\n    for",
        "        _storey_branch(run, i)\n        run.slots[of(i, c.OFFSET)] = 0.0\n    for",
        f"{VERIFICATION}/test_histories_reference.py::test_states_are_those_of_the_reference",
    ),
    Mutant(
        "histories: the ground between samples takes the first one's value",
        f"{SOLVE}/histories.py",
        "begins = starts[segment] + slopes[segment] * (cuts[:-1] - dt * segment)",
        "begins = starts[segment]",
        f"{UNIT}/solve/test_histories.py::test_the_output_step_need_not_divide_the_motions",
    ),
    Mutant(
        "histories: a storey on its lower yield line is taken for one on the upper",
        f"{SOLVE}/histories.py",
        "s.line * limit)",
        "np.abs(s.line) * limit)",
        f"{UNIT}/solve/test_histories.py::test_the_largest_values_are_the_peaks",
    ),
    Mutant(
        "histories: accelerations without the storeys' dashpots",
        f"{SOLVE}/histories.py",
        "shear + slots.dashpot * drift_rate, links)",
        "shear + 0.0 * drift_rate, links)",
        f"{UNIT}/solve/test_histories.py::test_the_largest_values_are_the_peaks",
    ),
    Mutant(
        "film: gaps at another scale than displacements",
        "pounding_cli/report/animation.py",
        "apart = [film.scale * gap if",
        "apart = [0.5 * film.scale * gap if",
        f"{UNIT}/report/test_report_animation.py::test_floors_touch_in_the_film_when_they_touch_in_the_scene",
    ),
]

MUTANTS: list[Mutant] = LINKS + STOREYS + MOTION + ENERGY + METHODS + DESIGN + GROUND + OTHERS + PRUNING + HISTORIES
