"""The faults: the place in the source, what is wrong in words, what makes it so, and the test that has to see it.

A place is a line marked `# fault: NAME`; several faults may share one. The piece of a line that changes is best short,
so that the fault outlives a change of the rest; a fault whose marker or piece is gone is an error."""

from __future__ import annotations

from .runner import Mutant

VERIFICATION, UNIT = "tests/verification", "tests/unit"

IMPACT = f"{VERIFICATION}/test_impact.py::test_printed_law"
WITHIN = f"{VERIFICATION}/test_impact.py::test_a_blow_within_one_step_of_the_motion"
HERTZ = f"{VERIFICATION}/test_hertz.py"
TENSION = f"{VERIFICATION}/test_impact.py::test_tension_cut"
INFILL = f"{VERIFICATION}/test_infill.py::test_peak_compression_of_an_undamped_infill"
INFILL_DAMPED = f"{VERIFICATION}/test_infill.py::test_damped_infill_against_the_reference"
INFILL_CUT = f"{VERIFICATION}/test_infill.py::test_an_infill_that_cannot_pull_presses_again_in_time"
CONNECTED = f"{VERIFICATION}/test_connected_pair.py::test_two_free_masses_on_a_connector"
THROW = f"{VERIFICATION}/test_hysteresis.py::test_throw_of_an_undamped_storey"
EVENTS = f"{VERIFICATION}/test_event_reference.py::test_pounding"
YIELDING = f"{VERIFICATION}/test_event_reference.py::test_yielding_connected_pair_with_a_tail"
P_DELTA = f"{VERIFICATION}/test_p_delta.py"
COLLAPSES, COLLAPSED_RUNS = f"{VERIFICATION}/test_collapse.py", "tests/cli/test_collapsed_runs.py"
LINEAR = f"{VERIFICATION}/test_linear_vibration.py"
COLUMNS = f"{VERIFICATION}/test_columns.py::test_columns_that_strike_columns"
TANGENT = f"{VERIFICATION}/test_tangent.py::test_change_of_the_peaks"
SHEARS = f"{VERIFICATION}/test_column_shears.py"
SLABS = f"{UNIT}/study/test_study_columns.py::test_slabs_whose_heights"
FOUNDED = f"{VERIFICATION}/test_foundation.py::test_shaken_building_against_exact_stepping"
ENERGIES = f"{VERIFICATION}/test_energy.py"
ORDERS = f"{VERIFICATION}/test_methods.py::test_declared_order_where_nothing_jumps"
ARIAS = f"{UNIT}/records/test_intensity.py::test_arias_of_a_triangle_is_exact"
SCALING = f"{UNIT}/records/test_scaling.py::test_arias_factor_reaches_the_target_motion"
CODE = f"{UNIT}/model/test_code_design.py"
STIFFNESS = f"{UNIT}/model/test_stiffness.py"
SENSITIVITY = f"{UNIT}/sensitivity/test_sensitivity_runs.py"
OPTIMISE = f"{UNIT}/optimise/test_optimise_runs.py"
REQUIRED, GAP = f"{VERIFICATION}/test_required_gap.py", "tests/cli/test_gap.py"
FRAGILE, FALLEN = f"{UNIT}/fragility", "tests/cli/test_fragility_undecided.py"

LINKS = [
    Mutant("dashpot-mass", "eq. (7) with m' upside-down, as printed", ("is DashpotLaw", "is not DashpotLaw"), IMPACT),
    Mutant("reduced-mass", "m' is the sum of the masses' half", "reduced = 0.25 * (left_mass + right_mass)", IMPACT),
    Mutant("dashpot", "dashpot without its factor 2", ("return 2 * ", "return "), IMPACT),
    Mutant(
        "damping-ratio-of-restitution", "xi = -ln e / pi, without ln e under the root", "return -log / math.pi", IMPACT
    ),
    Mutant(
        "tension-cut-as-given",
        "tension dropped where the law as printed keeps it",
        ("self.tension_cut and ", ""),
        IMPACT,
    ),
    Mutant("tension-guard", "tension kept where it should be cut", ("FORCE, 0.0", "CLOSING, -1e300"), TENSION),
    Mutant(
        "gap-in-closing",
        "gap added instead of subtracted when looking for contact",
        ("self.gap if", "-self.gap if"),
        IMPACT,
    ),
    Mutant(
        "product-of-zero",
        "a force at rest that looks at the approach speed is no number",
        ("np.where((x == 0.0) | (y == 0.0), 0.0, a * x * y)", "a * x * y"),
        f"{HERTZ}::test_a_force_at_rest_needs_no_approach_speed",
    ),
    Mutant(
        "jankowski-release",
        "the dashpot acts while the floors part",
        ("force=self.spring, regular=2", "force=self.spring + dashpot * RATE, regular=4"),
        f"{VERIFICATION}/test_jankowski.py::test_the_restitution_asked_comes_out",
    ),
    Mutant(
        "bilinear-return",
        "a bilinear contact comes back along its stiff line over twice its yield closing",
        ("-limit, 1.0", "-2 * limit, 1.0"),
        f"{VERIFICATION}/test_bilinear_contact.py::test_the_restitution_asked_comes_out_of_the_blow_it_is_laid_out_for",
    ),
    Mutant(
        "bilinear-turns-up",
        "floors that press again within a bilinear contact yield too early",
        ("limit - apart", "0.5 * limit"),
        f"{VERIFICATION}/test_bilinear_contact.py::test_five_storeys_against_the_reference",
    ),
    Mutant(
        "damper",
        "a damper of half its dashpot",
        ("dashpot=self", "dashpot=0.5 * self"),
        f"{VERIFICATION}/test_damper.py::test_two_free_masses",
    ),
    Mutant(
        "friction-slips",
        "a friction damper that slips pushes half as much",
        ("offset=force", "offset=0.5 * force"),
        f"{VERIFICATION}/test_connectors.py::test_friction_of_two_free_masses",
    ),
    Mutant(
        "maxwell",
        "a Maxwell damper whose dashpot takes the rate of the spring alone",
        ("(k / c)", "(0.5 * k / c)"),
        f"{VERIFICATION}/test_connectors.py::test_maxwell_of_two_free_masses",
    ),
    Mutant(
        "memory-flows",
        "the memory of a Maxwell damper moves by the first order of its rate",
        ("product_term(p.B, rate, k - 1)", "product_term(p.B, rate, 0)"),
        f"{VERIFICATION}/test_connectors.py::test_maxwell_of_two_free_masses",
    ),
    Mutant(
        "bouc-wen",
        "a Bouc-Wen storey that yields at twice its strength",
        ("1.0 - factor", "1.0 - 0.5 * factor"),
        f"{VERIFICATION}/test_bouc_wen.py::test_throw_and_return",
    ),
    Mutant(
        "bouc-wen-gamma",
        "gamma of a Bouc-Wen storey with the other sign",
        ("+ self", "- self"),
        f"{VERIFICATION}/test_bouc_wen.py::test_unloading_by_gamma",
    ),
    Mutant(
        "bouc-wen-exponent",
        "the exponent of a Bouc-Wen storey is one less",
        ("self.wen_exponent", "max(self.wen_exponent - 1, 1)"),
        f"{VERIFICATION}/test_bouc_wen.py::test_throw_and_return",
    ),
    Mutant(
        "bouc-wen-stores",
        "what the hysteretic part of a Bouc-Wen storey stores counts as lost",
        ("Z**2", "0.0"),
        f"{VERIFICATION}/test_bouc_wen.py::test_a_closed_loop_loses_its_area",
    ),
    Mutant(
        "smooth-storeys-refused",
        "methods that keep no memory run Bouc-Wen storeys on their first branch",
        ("memories_flow(scene)", "False"),
        f"{VERIFICATION}/test_bouc_wen.py::test_methods_that_keep_no_state_refuse_them",
    ),
    Mutant(
        "cost-of-smooth-storeys",
        "the cost of Bouc-Wen storeys is that of bilinear ones",
        ("memories_flow(scene)", "False"),
        f"{UNIT}/batch/test_batch_forecast.py::test_smooth_storeys_cost_more_where_they_yield",
    ),
    Mutant(
        "storey-pushes-below",
        "what flows in a storey pushes both its floors the same way",
        ("+=", "-="),
        f"{VERIFICATION}/test_bouc_wen.py::test_many_cycles",
    ),
    Mutant(
        "shear-flows",
        "the peak of a smooth shear misses half of what flows",
        ("per_memory * series", "0.5 * per_memory * series"),
        f"{VERIFICATION}/test_bouc_wen.py::test_throw_and_return",
    ),
    Mutant(
        "storey-loses",
        "half of what a smooth storey stores counts as lost",
        ("(ends - held)", "0.5 * (ends - held)"),
        f"{VERIFICATION}/test_bouc_wen.py::test_throw_and_return",
    ),
    Mutant(
        "memory-followed",
        "a memory is followed as far as the last orders of its series tell",
        ("max(0.9 * (allowed / defect) ** (1.0 / order), 0.25)", "1.0"),
        f"{VERIFICATION}/test_bouc_wen.py::test_a_sharp_storey_is_nearly_bilinear",
    ),
    Mutant(
        "viscous",
        "the power of a viscous damper is that of the square root of the rate",
        ("0.25 * (a - 1.0)", "0.125 * (a - 1.0)"),
        f"{VERIFICATION}/test_connectors.py::test_viscous_of_two_free_masses",
    ),
    Mutant(
        "link-that-strikes",
        "of links between the same floors the first keeps the row of the floors, whatever it is",
        ("if links[number].law.subtracts_gap", "if True"),
        f"{UNIT}/study/test_several_links.py::test_rows_of_tables",
    ),
    Mutant(
        "pressed-from-rest",
        "floors that rest in touch are asked whether they press in the last step of a segment only",
        "pressed = finished and _presses(run, p)",
        f"{HERTZ}::test_hard_contacts[0.0-1000000000000.0-None-0.05]",
    ),
    Mutant(
        "pressed-soon",
        "where a force from rest begins to be resolved is looked for in the whole step at once",
        "within = end",
        f"{VERIFICATION}/test_jankowski.py::test_hard_contacts[0.0-1000000000000.0-0.01-0.05]",
    ),
    Mutant(
        "end-decides",
        "a storey that turned six times at one instant stays where it is, whatever the step brings",
        "return s",
        "tests/hard/test_behaviour.py::test_rest_without_strength",
    ),
    Mutant(
        "no-time",
        "time below the last digit of a step counts as time",
        "if pinned_at_event and clock[END] > 0.0:",
        "tests/hard/test_behaviour.py::test_rest_without_strength",
    ),
    Mutant(
        "contact-begins",
        "contact begins at the end of the step",
        "{line}; s = 1.0 if s <= end else s",
        IMPACT,
    ),
    Mutant(
        "closing-is-monotone",
        "a closing that turns within the step is taken as monotone",
        ("~may_turn_by_ends(first, last, deviation) & ", ""),
        WITHIN,
    ),
    Mutant(
        "step-is-whole",
        "a step at the pace of the one before passes for the rest of the segment",
        "return True",
        EVENTS,
    ),
    Mutant(
        "link-pushes-floors", "contact pushes the right floor with half the force", ("+ gain", "+ 0.5 * gain"), IMPACT
    ),
    Mutant("link-pushes-floors", "contact does not push the left floor", ("- gather", "- 0.0 * gather"), IMPACT),
    Mutant("impulse", "impulse without the length of the step", ("held,", "applied,"), IMPACT),
    Mutant(
        "contact-from-rest",
        "contact of floors that begin in touch counts from where a double tells it",
        ("time *", "run.clock[H] * run.clock[END] *"),
        f"{VERIFICATION}/test_impact.py::test_floors_in_touch_press_from_the_start_or_not_at_all",
    ),
    Mutant("infill-cubic", "infill's cubic without the 3 in 3 d^2", ("(3 * d**2)", "d**2"), INFILL),
    Mutant("infill-stiffened", "infill jumps at v = d, as eq. (9) is printed", ("CONTINUOUS", "PRINTED"), INFILL),
    Mutant(
        "infill-root-dashpot",
        "infill's dashpot with the left mass instead of m'",
        ("sqrt(mass)", "sqrt(left_mass)"),
        INFILL_DAMPED,
    ),
    Mutant("infill-slope-of-root", "infill's dashpot keeps the slope at v = 0", "root = 0.0 * roots", INFILL_DAMPED),
    Mutant("infill-guard", "infill never stiffens at v = d", ("rises_above(d", "rises_above(1e6 * d"), INFILL),
    Mutant(
        "branch-at-rest",
        "connector holds in compression only",
        ("links.first,", "np.zeros_like(links.first),"),
        YIELDING,
    ),
]

STOREYS = [
    Mutant(
        "storey-elastic-tangent",
        "unloading with the hardened stiffness",
        ("k, offset", "a * k, offset"),
        THROW,
    ),
    Mutant(
        "storey-unloads",
        "a storey keeps the stiffness of the branch that it leaves",
        "pass",
        THROW,
    ),
    Mutant(
        "p-delta-below",
        "P-Delta stiffens a storey",
        (" - slots[of(i, c.GEOMETRIC)]", " + slots[of(i, c.GEOMETRIC)]"),
        f"{P_DELTA}::test_slope_after_yield",
    ),
    Mutant(
        "p-delta-energy",
        "what the weights lose in height is counted twice",
        ("0.5 * ", ""),
        f"{P_DELTA}::test_slope_after_yield",
    ),
    Mutant(
        "unstable-at-rest",
        "a storey without any stiffness left is run",
        ("theta >= 1", "theta > 1"),
        f"{P_DELTA}::test_unstable_at_rest_is_refused",
    ),
    Mutant(
        "collapse-in-time",
        "a collapse is looked for where a link or storey has an event anyway",
        ("settings.watched > 0 and", "settings.watched > 0 and (storeys or link) and"),
        f"{COLLAPSES}::test_time_in_closed_form",
    ),
    Mutant(
        "where-it-collapses",
        "a collapse is placed later in its step than the drift is passed",
        ("= s", "= s + 0.02"),
        f"{COLLAPSES}::test_time_in_closed_form",
    ),
    Mutant(
        "collapse-on-program",
        "a collapse is not looked for where a force is written as operations",
        ("watched > 0", "watched > 1"),
        f"{COLLAPSES}::test_during_contact",
    ),
    Mutant(
        "drift-of-collapse",
        "every storey collapses at 10 %, whatever is asked",
        ("self.collapse *", "COLLAPSE *"),
        f"{COLLAPSES}::test_where_it_is_looked_for",
    ),
    Mutant(
        "stands-apart",
        "buildings that stand apart do not end at the collapse of another",
        (" and not arrays.collapses", ""),
        f"{COLLAPSES}::test_buildings_that_stand_apart_end_at_one_time",
    ),
    Mutant(
        "ends-alike",
        "runs that end with the collapse of different storeys are compared by their peaks",
        "return True",
        f"{COLLAPSES}::test_two_accuracies_that_disagree",
    ),
    Mutant(
        "peaks-of-a-collapse",
        "the peaks of a scene that collapsed count in the statistics",
        ("== DONE", "in OUTCOMES"),
        f"{COLLAPSED_RUNS}::test_run_show_and_compare",
    ),
    Mutant(
        "collapses-counted",
        "records with a collapse are not counted",
        ("== COLLAPSED", '== ""'),
        f"{COLLAPSED_RUNS}::test_run_show_and_compare",
    ),
    Mutant(
        "another-outcome",
        "a collapse in one of two results files is no difference",
        ("!= other", "!= one"),
        f"{COLLAPSED_RUNS}::test_run_show_and_compare",
    ),
    Mutant(
        "a-collapse-is-no-failure",
        "a collapse is told as a scene that failed",
        ("isin(OUTCOMES)", "isin(OUTCOMES[:1])"),
        f"{COLLAPSED_RUNS}::test_export_and_page",
    ),
    Mutant("storey-remembers", "plastic drift of the wrong side", ("DRIFT + limit", "DRIFT - limit"), THROW),
    Mutant(
        "storey-turns-at-rest",
        "a storey that turns back is not known to stand where it would go on",
        ("return g", "return 0"),
        YIELDING,
    ),
    Mutant(
        "yield-plateau",
        "post-yield line starts at Vy instead of (1 - a) Vy",
        ("(1 - self.hardening) * ", ""),
        THROW,
    ),
    Mutant("yield-guard", "no yielding on the lower line", ("-limit", "-9.0 * limit"), THROW),
    Mutant(
        "storey-guard-root",
        "yielding and unloading at the end of the step",
        "s = 1.0 if s <= 1.0 else s; {line}",
        THROW,
    ),
    Mutant("storeys-can-yield", "inelastic runs stay elastic", ("and buildings", "and not buildings"), THROW),
    Mutant(
        "stencil-own-rate",
        "Rayleigh's beta on the tangent stiffness",
        ("-(dashpot + ", "-(dashpot * below / max(slots[of(i, c.STIFFNESS)], 1.0) + "),
        YIELDING,
    ),
]

MOTION = [
    Mutant(
        "ground-pushes-floors",
        "ground input missing on one floor",
        ("[span]", "[span.start + 1 : span.stop]"),
        f"{LINEAR}::test_five_storeys_against_exact_stepping",
    ),
    Mutant(
        "stencil-right",
        "storey above pulls the floor the wrong way",
        ("= above", "= -above"),
        f"{LINEAR}::test_five_storeys_against_exact_stepping",
    ),
    Mutant(
        "program-ground",
        "program steps: the ground does not move",
        ("* ground", "* 0.0 * ground"),
        "tests/verification/test_program_step.py::test_written_laws_are_those_of_tables",
    ),
    Mutant(
        "neighbours-may-meet",
        "neighbours that may meet are left apart",
        "pass",
        f"{VERIFICATION}/test_islands.py::test_islands_equal_the_row",
    ),
    Mutant(
        "island-velocities-restored",
        "an island solved again begins with the velocities it ended with",
        "store(run.W, b, load(run.W, b))",
        f"{VERIFICATION}/test_islands.py::test_islands_equal_the_row",
    ),
    Mutant(
        "island-slots-restored",
        "an island solved again keeps the energies of what was taken back",
        ("STOREY_MEMORY, SPRING_FORCE", "STOREY_MEMORY, INPUT_ENERGY"),
        f"{VERIFICATION}/test_islands.py::test_islands_equal_the_row",
    ),
    Mutant(
        "island-slots-restored",
        "an island solved again keeps what its smooth storeys remember",
        ("= STOREY_MEMORY", "= STOREY_MEMORY + 8"),
        f"{VERIFICATION}/test_bouc_wen.py::test_chain_of_ten",
    ),
    Mutant(
        "island-stencils-restored",
        "an island solved again keeps the stencils of what was taken back",
        "pass",
        f"{VERIFICATION}/test_islands.py::test_islands_equal_the_row",
    ),
    Mutant(
        "island-links-restored",
        "an island solved again keeps the impacts of what was taken back",
        ("BRANCH, 8 * LINK_INTEGERS", "BRANCH, IMPACTS"),
        f"{VERIFICATION}/test_islands.py::test_islands_equal_the_row",
    ),
    Mutant(
        "alone-neighbours-rates",
        "a floor of a building alone does not feel the velocity of the one below",
        ("from_left(zero, w)", "zero"),
        f"{LINEAR}::test_five_storeys_against_exact_stepping",
    ),
    Mutant(
        "stands-apart",
        "an event anywhere ends the step of the whole row",
        ("not all_effects", "all_effects"),
        f"{VERIFICATION}/test_islands.py::test_what_stands_apart_takes_its_own_steps_two_by_two",
    ),
    Mutant(
        "lined-up-push",
        "links that join like places push the wrong way",
        ("pushed", "0.999999 * pushed"),
        f"{VERIFICATION}/test_event_reference.py::test_five_storeys",
    ),
    Mutant(
        "ground-in-series",
        "ground acceleration held between samples",
        ("* ground", "* (ground if k == 0 else splat(0.0))"),
        f"{LINEAR}::test_forced_vibration_under_straight_lines",
    ),
    Mutant(
        "ground-in-tail",
        "the motion's last slope goes on in the tail",
        ("(slopes, tail)", "(slopes, tail + slopes[-1])"),
        f"{LINEAR}::test_a_tail_is_free_vibration",
    ),
    Mutant(
        "mass-damping",
        "mass-proportional damping left out",
        "slots.alpha[span] = 0.0",
        f"{LINEAR}::test_free_vibration",
    ),
    Mutant(
        "stiffness-damping",
        "stiffness-proportional damping doubled",
        ("= building", "= 2 * building"),
        f"{LINEAR}::test_free_vibration",
    ),
    Mutant(
        "root-search-gives-up",
        "a root search that gives up says never",
        "return NEVER",
        f"{UNIT}/kernels/test_polynomial.py::test_a_root_of_several_in_one_is_found",
    ),
    Mutant(
        "root-search-gives-up",
        "a root search that gives up says that it has arrived",
        "return s",
        f"{UNIT}/kernels/test_polynomial.py::test_a_root_of_several_in_one_is_found",
    ),
    Mutant(
        "highest-within-step",
        "peaks at the ends of steps only",
        ("n < 2 ", "n < 200 "),
        f"{LINEAR}::test_free_vibration",
    ),
    Mutant(
        "series-tolerance",
        "series cut off seven digits too early",
        ("* tolerance", "* (1e7 * tolerance)"),
        f"{LINEAR}::test_free_vibration",
    ),
    Mutant(
        "cut-series-ends", "series end before a force that is cut off has converged", ("> 1.0", "> 1e300"), INFILL_CUT
    ),
    Mutant(
        "cut-shortens-steps",
        "steps are not shortened for a force that is cut off",
        ("size, _", "size, 1e-300 * _"),
        INFILL_CUT,
    ),
    Mutant(
        "acceleration-is-total",
        "floor acceleration relative to the ground",
        "ground_end = splat(0.0)",
        f"{LINEAR}::test_peaks_under_a_single_ramp",
    ),
    Mutant("base-drag", "structural damping does not see the base move", ("-1.0", "-0.0"), FOUNDED),
    Mutant("point-hands-on", "a storey that leans does not turn its base", ("+= ", "+= 0.0 * "), FOUNDED),
    Mutant("point-follows", "the foot of a storey moves the other way", ("= terms", "= -terms"), FOUNDED),
    Mutant("spring-pushes-back", "a dashpot between floors and base pushes", ("-= push", "+= push"), FOUNDED),
    Mutant("columns-shape", "columns are straight between floors", ("at * at * (3.0 - 2.0 * at)", "at"), COLUMNS),
    Mutant(
        "column-shears",
        "a blow's own force is left out above it",
        ("if higher else -to_above", "if higher else 0.0"),
        f"{SHEARS}::test_one_blow_on_columns_that_stand_still",
    ),
    Mutant(
        "slabs-that-meet", "slabs meet by one thickness alone", ("<= reach", "<= 0.5 * reach"), f"{SLABS}_overlap_meet"
    ),
    Mutant(
        "column-flexibility",
        "struck columns are clamped at one end alone",
        ("(at * (1.0 - at)) ** 3", "at**3"),
        f"{UNIT}/study/test_study_columns.py::test_flexibility_of_the_columns_is_that_of_a_clamped_beam",
    ),
]

ENERGY = [
    Mutant(
        "spring-dissipates",
        "dashpots between floors and a moving base take no energy",
        ("+= ", "+= 0.0 * "),
        f"{ENERGIES}::test_balance_closes_with_the_accuracy",
    ),
    Mutant(
        "ground-input",
        "input of the ground with the wrong sign",
        ("- mass", "+ mass"),
        f"{ENERGIES}::test_work_of_the_ground",
    ),
    Mutant(
        "hysteresis",
        "hysteresis a tenth too large",
        ("mean * ", "1.1 * mean * "),
        THROW,
    ),
    Mutant(
        "links-energy",
        "energy stored in links counted twice",
        ("on_links - ", "on_links + "),
        f"{ENERGIES}::test_connector_dashpot_and_spring",
    ),
]

METHODS = [
    Mutant(
        "ground-of-a-step",
        "fixed steps: the ground stands still from sample to sample",
        ("(part * whole + gone)", "0.0"),
        f"{ORDERS}[rk4]",
    ),
    Mutant(
        "event-ends-step",
        "RK4 with events: a step is not taken again up to the event",
        "pass",
        f"{VERIFICATION}/test_methods.py::test_location_keeps_the_order_at_contacts",
    ),
    Mutant(
        "generalized-alpha-shares",
        "HHT-alpha: the old forces have no share",
        ("- alpha_f * p.a[i]", ""),
        f"{ORDERS}[hht-alpha]",
    ),
    Mutant(
        "generalized-alpha-shares",
        "generalized-alpha: the old acceleration has no share",
        ("alpha_m * (", "0.0 * ("),
        f"{ORDERS}[generalized-alpha]",
    ),
    Mutant(
        "runge-kutta-stages",
        "RK4: a stage counted with 1.9 instead of 2",
        ("2.0 * (q2.a[i] + q3.a[i])", "1.9 * q2.a[i] + 2.0 * q3.a[i]"),
        f"{ORDERS}[rk4]",
    ),
    Mutant(
        "central-difference-velocity",
        "central difference: velocity of the half step taken for the step's",
        ("1.5 * half[i] - 0.5 * before", "half[i]"),
        f"{ORDERS}[central-difference]",
    ),
    Mutant("newmark-gamma", "Newmark with gamma = 0.52", ("0.5 ", "0.52 "), f"{ORDERS}[newmark]"),
    Mutant(
        "estimated-error",
        "estimated error of the finer run instead of the response's",
        ("difference(response,", "difference(second,"),
        f"{UNIT}/solve/test_assess.py::test_the_error_is_that_of_the_response_and_not_of_the_finer_run",
    ),
    Mutant(
        "tangent-jumps",
        "velocities of the tangent do not jump where a force does",
        ("+= run.slots", "+= 0.0 * run.slots"),
        f"{TANGENT}[elastic, touching]",
    ),
    Mutant(
        "tangent-remembers",
        "the tangent of a storey forgets the drift at which it turned back",
        ("(former - stiffness)", "0.0 * (former - stiffness)"),
        f"{TANGENT}[weak, gap]",
    ),
    Mutant(
        "tangent-of-infill",
        "an infill does not stiffen in the tangent",
        ("3.0 * cubic", "0.0 * cubic"),
        f"{TANGENT}[infill, elastic]",
    ),
    Mutant(
        "tangent-of-durations",
        "a contact that hardly begins moves a bound no more than others",
        ("max(abs(shift), least)", "0.0"),
        f"{VERIFICATION}/test_tangent.py::test_no_number_changes_more",
    ),
    Mutant(
        "bound-is-low",
        "what contacts hand on of an error does not count",
        ("(CUT + OF", "1e-3 * (CUT + OF"),
        f"{VERIFICATION}/test_tangent.py::test_bounds_are_above_the_true_error",
    ),
    Mutant(
        "known-sensitivity",
        "a sensitivity that the tangent tells is measured once more",
        ("sensitivity <= MOST_SENSITIVE", "False"),
        f"{UNIT}/solve/test_assess.py::test_where_the_bound_is_too_large_one_run_measures_the_error",
    ),
    Mutant(
        "bound-of-closings",
        "the error of the closings between groups is left out of that of the row",
        ("first.error_estimate", "0.0"),
        f"{UNIT}/solve/test_groups.py::test_a_run_that_tells_the_error_of_closings_needs_no_finer_one",
    ),
    Mutant(
        "bound-meets-accuracy",
        "the bound of a coarse run counts where a finer accuracy is asked",
        (" and response.error_estimate <= accuracy", ""),
        f"{UNIT}/solve/test_assess.py::test_a_bound_above_the_accuracy_that_is_asked_is_not_taken",
    ),
    Mutant(
        "harmless-at-once",
        "a scene that may miss the accuracy is told by one run",
        ("error <= HARMLESS * accuracy and ", ""),
        f"{UNIT}/solve/test_assess.py::test_a_response_that_misses_the_accuracy_gives_way_to_the_finer_run",
    ),
    Mutant(
        "scatter-of-rounding",
        "an estimate where rounding decides is that of two runs, which may lie close by chance",
        ("*(difference(response, other) for other in others)", ""),
        f"{UNIT}/solve/test_assess.py::test_runs_that_lie_close_by_chance_do_not_settle_what_rounding_decides",
    ),
    Mutant(
        "estimated-columns",
        "drifts at the end are outside the estimated error",
        "",
        f"{UNIT}/solve/test_assess.py::test_every_column_is_covered",
    ),
    Mutant(
        "held-in-finer-runs",
        "a base that is held fixed is resolved in the finer runs",
        ("accuracy)", "finer(accuracy))"),
        f"{UNIT}/solve/test_assess.py::test_a_base_that_is_held_fixed_is_held_in_the_finer_runs",
    ),
    Mutant(
        "finer-response-is-kept",
        "a response that misses the accuracy asked is kept",
        "pass",
        f"{UNIT}/solve/test_assess.py::test_a_response_that_misses_the_accuracy_gives_way_to_the_finer_run",
    ),
]

DESIGN = [
    Mutant("ubc-1991-c", "UBC 1991: C = 1.2 S / T^(2/3)", ("1.25", "1.2"), f"{CODE}::test_base_shear_coefficient"),
    Mutant(
        "ubc-1985-cs",
        "UBC 1985: C S not bounded",
        ("min(c * self.soil, 0.14)", "c * self.soil"),
        f"{CODE}::test_base_shear_coefficient",
    ),
    Mutant("ubc-top-force", "F_t at the roof omitted", ("0.7 ", "70 "), f"{CODE}::test_top_force"),
    Mutant(
        "ubc-displacement", "separation with 3 Rw / 4", ("/ 8", "/ 4"), f"{CODE}::test_separation_of_the_paper_s_pair"
    ),
    Mutant(
        "ubc-storey-shears",
        "storey shears summed from the ground up",
        "return np.cumsum(forces)",
        f"{CODE}::test_storey_shears_below_the_top_force_s_period",
    ),
    Mutant(
        "stiffness-taper",
        "taper reversed: stiff at the top",
        ("1.0, ratio", "ratio, 1.0"),
        f"{STIFFNESS}::test_the_period_asked_for_is_the_period_found",
    ),
    Mutant(
        "rayleigh-frequencies",
        "Rayleigh factors of the first mode alone",
        ("w[min(1, w.size - 1)]", "w[0]"),
        f"{STIFFNESS}::test_rayleigh_damping_of_the_first_two_modes",
    ),
]

GROUND = [
    Mutant("arias", "Arias intensity with g squared", ("GRAVITY", "GRAVITY**2"), ARIAS),
    Mutant(
        "arias-straight-lines",
        "Arias intensity by the trapezoid of squares",
        ("a[:-1] ** 2 + a[:-1] * a[1:] + a[1:] ** 2", "1.5 * a[:-1] ** 2 + 1.5 * a[1:] ** 2"),
        ARIAS,
    ),
    Mutant(
        "scaling-target",
        "scaling by the peak instead of the Arias intensity",
        ("arias(target)", "arias(motion) * (target.pga / motion.pga) ** 2"),
        SCALING,
    ),
    Mutant("scaling-factor", "scale factor without the square root", ("math.sqrt(", "("), SCALING),
]

OTHERS = [
    Mutant(
        "oscillators-determinant",
        "Fig. 5: determinant with the wrong sign",
        ("+ z", "- z"),
        f"{UNIT}/connector/test_oscillators.py::test_ratios_against_a_linear_solver",
    ),
    Mutant(
        "von-mises",
        "wall: von Mises without the 3 before the shear",
        ("3 * t", "t"),
        f"{UNIT}/wall/test_stress.py::test_von_mises",
    ),
    Mutant(
        "plane-strain",
        "wall: (1 - nu) instead of (1 - nu^2)",
        ("nu**2", "nu"),
        f"{UNIT}/wall/test_assembly.py::test_wall_stiffness_against_the_librarys_elasticity",
    ),
    Mutant(
        "striker-lets-go",
        "wall: the striker is glued to the wall",
        "force = force + 0.0",
        f"{UNIT}/wall/test_transient.py::test_unilateral_force_never_pulls_and_the_gap_never_closes_through",
    ),
    Mutant(
        "frame-bending",
        "frame: bending stiffness 6 EI / L^3",
        ("(3, 12)", "(3, 6)"),
        f"{UNIT}/wall/test_frame.py::test_cantilever",
    ),
    Mutant(
        "deviation",
        "tables: deviation over n instead of n - 1",
        ("count - 1", "count"),
        "tests/peers/test_record_statistics.py::test_against_pandas",
    ),
    Mutant(
        "ratio",
        "tables: V0 / V instead of V / V0",
        ("value, alone,", "alone, value,"),
        f"{UNIT}/store/test_store_results.py::test_storey_table_has_one_row_per_storey_that_exists",
    ),
]

EXACT = f"{VERIFICATION}/test_effects.py::test_exact_steps_equal_the_series"
OPEN_GAP = f"{VERIFICATION}/test_effects.py::test_a_gap_is_only_called_open_when_it_is"
APART = f"{VERIFICATION}/test_effects.py::test_a_row_falls_apart_where_nothing_closes"
RIGID = f"{VERIFICATION}/test_effects.py::test_rigid_foundation_is_held_fixed"

PRUNING = [
    Mutant("exact-acceleration", "exact steps: accelerations without the ground's", ("+= ", "+= 0.0 * "), EXACT),
    Mutant(
        "exact-energy-series",
        "exact steps: energy of a sample by a series with k instead of k + 1",
        ("(j + 1)", "j"),
        EXACT,
    ),
    Mutant("exact-ground-work", "exact steps: the ground's work with the wrong sign", ("-system", "system"), EXACT),
    Mutant(
        "exact-peaks", "exact steps: peaks only at the ends of steps", ("above + deviation", "above - deviation"), EXACT
    ),
    Mutant(
        "exact-leap",
        "exact steps: before the ground stops they are as bent as after it",
        (" * leapt", " * 0.0"),
        f"{VERIFICATION}/test_effects.py::test_exact_steps_find_a_peak_just_before_the_ground_stops",
    ),
    Mutant(
        "exact-monotone",
        "exact steps: a step counts as monotone too soon",
        ("4.0", "0.5"),
        f"{VERIFICATION}/test_effects.py::test_exact_steps_find_peaks_between_spikes",
    ),
    Mutant(
        "gap-stays-open",
        "a gap counts as open if it is nearly as wide as the largest closing",
        (">= link.law", ">= 1.01 * link.law"),
        OPEN_GAP,
    ),
    Mutant(
        "columns-never-struck",
        "columns that nothing strikes are told the whole storey's shear",
        ("shear, shear", "shear / each.share, shear"),
        f"{SHEARS}::test_columns_that_are_never_struck",
    ),
    Mutant(
        "closing-between-groups",
        "a link between groups has no closing",
        ("= closings[link]", "= 0.0 * closings[link]"),
        APART,
    ),
    Mutant(
        "base-held-fixed",
        "a rigid foundation is judged without the building's height",
        ("stiffest * tall**2", "stiffest"),
        RIGID,
    ),
    Mutant(
        "elastic-never-yields",
        "elastic storeys yield when the kernel could let them",
        ("== Analysis.INELASTIC", "in (Analysis.INELASTIC, Analysis.ELASTIC)"),
        f"{VERIFICATION}/test_effects.py::test_looking_for_yielding_changes_nothing_in_an_elastic_scene",
    ),
    Mutant(
        "mean-of-errors",
        "tables: the error of a mean is the sum of its records'",
        ("known.sum(axis=axis) if", "1 + 0 * known.sum(axis=axis) if"),
        f"{UNIT}/store/test_store_trust.py::test_errors_add_up_and_sensitivities_are_weighted",
    ),
]

HISTORIES = [
    Mutant(
        "run-goes-on",
        "a run that goes on forgets its plastic drifts",
        "{line}; run.slots[of(i, c.OFFSET)] = 0.0",
        f"{VERIFICATION}/test_histories_reference.py::test_states_are_those_of_the_reference",
    ),
    Mutant(
        "history-ground",
        "histories: the ground between samples takes the first one's value",
        "begins = starts[segment]",
        f"{UNIT}/solve/test_histories.py::test_the_output_step_need_not_divide_the_motions",
    ),
    Mutant(
        "history-closing",
        "histories: closings are those of the floors, also at columns",
        "closing=None,",
        f"{UNIT}/api/test_api_views.py::test_closings_at_columns_are_those_of_the_struck_point",
    ),
    Mutant(
        "history-storey-branch",
        "histories: a storey on its lower yield line is taken for one on the upper",
        ("b - first", "min(b - first, 1)"),
        f"{UNIT}/solve/test_histories.py::test_the_largest_values_are_the_peaks",
    ),
    Mutant(
        "history-accelerations",
        "histories: accelerations without the storeys' dashpots",
        ("+=", "+= 0.0 *"),
        f"{UNIT}/solve/test_histories.py::test_the_largest_values_are_the_peaks",
    ),
    Mutant(
        "inset-struck-point",
        "insets: a slab that strikes columns touches the floor above",
        ('row[f"{side}_at"] * ', ""),
        f"{UNIT}/report/test_report_figures.py::test_storeys_of_several_heights_are_drawn_to_one_scale",
    ),
]

ANSWERS = [
    Mutant(
        "first-round",
        "a finished search is compared with the plan of its last round",
        "pass",
        f"{OPTIMISE}::test_a_finished_search_is_not_made_again",
    ),
    Mutant(
        "order-of-samples",
        "the indices of the keys are those of the keys from the last to the first",
        ("factor + 1", "keys - factor"),
        f"{SENSITIVITY}::test_ishigami_within_the_confidence_given",
    ),
    Mutant(
        "equal-samples",
        "a sample equal to an earlier one takes the number of the latest",
        ("first[values]", "len(kept) - 1"),
        f"{SENSITIVITY}::test_morris_ranks_the_keys",
    ),
    Mutant(
        "failed-sample",
        "an index is given though samples failed",
        ("np.isnan(y).sum()", "0"),
        f"{SENSITIVITY}::test_a_failing_scene_is_solved_harder_and_then_refuses_the_index",
    ),
    Mutant(
        "ends-of-an-index",
        "the interval of an index leaves out ten times as many draws",
        ("[tails, 100 - tails]", "[10 * tails, 100 - 10 * tails]"),
        f"{SENSITIVITY}::test_the_interval_of_an_index_holds_the_truth_as_often_as_it_says",
    ),
    Mutant(
        "ends-of-an-output",
        "the interval of a mean leaves out ten times as many draws",
        ("[tails, 100 - tails]", "[10 * tails, 100 - 10 * tails]"),
        f"{SENSITIVITY}::test_ishigami_within_the_confidence_given",
    ),
    Mutant(
        "order-of-bootstraps",
        "outputs of samples whose motions are drawn come back in the order of the draws",
        ('np.argsort(question.motion_set, kind="stable")', "question.motion_set"),
        f"{UNIT}/sensitivity/test_claim_odds.py::test_outputs_rest_on_the_motions_that_a_bootstrap_drew",
    ),
    Mutant(
        "harder-try",
        "a scene that failed is not solved more finely",
        ("task._caught(scene, task.respond, scene, False)", "response"),
        f"{SENSITIVITY}::test_scenes_that_a_harder_try_cures_cost_no_index",
    ),
    Mutant(
        "level-of-morris",
        "a level of Morris stands for the low end of its share of the probability",
        ("+ 0.5", "+ 0.0"),
        f"{SENSITIVITY}::test_morris_ranks_the_keys",
    ),
    Mutant(
        "worst-of-the-sweep",
        "the best point of a sweep beside counts as the worst",
        ("argmax", "argmin"),
        f"{OPTIMISE}::test_of_a_sweep_beside_the_worst_or_the_mean",
    ),
    Mutant(
        "flat-bottom",
        "the flat region of an optimum is taken ten times as deep",
        ("FLAT * abs", "10 * FLAT * abs"),
        f"{UNIT}/optimise/test_optimise_search.py::test_the_flat_bottom",
    ),
]

GAPS = [
    Mutant(
        "required-gap",
        "every motion requires the mean of all",
        ('found["max_closing"]', 'found["max_closing"].mean(axis=2, keepdims=True) + 0 * found["max_closing"]'),
        f"{GAP}::test_statistics_are_those_of_the_closings",
    ),
    Mutant(
        "gap-beside-columns",
        "nothing is required where a slab faces columns",
        ("in strikes", "in ()"),
        f"{REQUIRED}::test_slabs_beside_columns",
    ),
    Mutant(
        "gap-deviation",
        "required gaps: deviation over n motions instead of n - 1",
        ("count - 1", "count"),
        f"{GAP}::test_statistics_are_those_of_the_closings",
    ),
    Mutant(
        "gap-of-a-probability",
        "the gap for a probability of contact is that of staying apart so often",
        ("isf", "ppf"),
        f"{GAP}::test_statistics_are_those_of_the_closings",
    ),
    Mutant(
        "gap-interval",
        "the confidence interval of a gap for a probability of contact is that of the median",
        ("z * root", "0.0"),
        f"{GAP}::test_confidence_interval_holds_as_often_as_it_says",
    ),
    Mutant(
        "gap-few-motions",
        "the confidence interval of a gap is told of two motions",
        ("FEWEST", "2"),
        f"{GAP}::test_no_interval_of_few_motions",
    ),
    Mutant(
        "gap-of-a-case",
        "a gap is enough where one floor alone stays open",
        (".all(axis=1)", ".any(axis=1)"),
        f"{GAP}::test_a_gap_that_is_enough_stays_open_and_one_that_is_not_closes",
    ),
    Mutant(
        "property-line-side",
        "the displacement to one side counts for the other",
        (
            '-found["displacement_min"], found["displacement_max"]',
            'found["displacement_max"], -found["displacement_min"]',
        ),
        f"{GAP}::test_property_line_of_an_oscillator",
    ),
    Mutant(
        "asce7-displacement",
        "ASCE 7 multiplies by the importance factor",
        ("/ importance", "* importance"),
        f"{GAP}::test_rules_of_codes_by_hand",
    ),
    Mutant(
        "en1998-same-floors",
        "EN 1998-1 takes 0.7 whether or not the floors line up",
        ("np.where(same_floors, 0.7, 1.0)", "0.7"),
        f"{GAP}::test_seven_tenths_where_the_floors_have_the_same_elevations",
    ),
    Mutant(
        "double-difference",
        "DDC adds what buildings that sway alike have in common",
        ("- 2", "+ 2"),
        f"{UNIT}/model/test_separation.py::test_rules_of_peaks",
    ),
]

FRAGILITY = [
    Mutant(
        "failed-scene-of-ida",
        "a scene that failed counts as holding in a bracket",
        ("demand <= 1", "not demand > 1"),
        f"{FRAGILE}/test_hunt.py::test_failed_scenes_widen_the_bracket_and_end_nothing",
    ),
    Mutant(
        "failed-scene-of-stripes",
        "a scene that failed counts as holding in a stripe",
        ("~np.isnan(self.demand)", "self.asked"),
        f"{FRAGILE}/test_fragility_runs.py::test_failed_scenes_of_stripes_count_neither_as_holding_nor_as_passing",
    ),
    Mutant(
        "failed-scene-of-ida",
        "a scene that a collapse left undecided counts as holding in a bracket",
        (" and demand != UNDECIDED", ""),
        f"{FRAGILE}/test_fragility_collapse.py::test_undecided_motions_are_censored",
    ),
    Mutant(
        "failed-scene-of-stripes",
        "a scene that a collapse left undecided counts as holding in a stripe",
        (" & ~self.undecided", ""),
        f"{FRAGILE}/test_fragility_collapse.py::test_undecided_scenes_of_stripes_are_left_out_of_the_counts",
    ),
    Mutant(
        "failed-scenes-counted",
        "a scene that a collapse left undecided counts as failed",
        ("np.isnan(self.demand)", "~(self.demand > UNDECIDED)"),
        f"{FRAGILE}/test_fragility_collapse.py::test_a_building_that_falls",
    ),
    Mutant(
        "demand-of-collapse",
        "a scene that ended with a collapse counts as holding",
        ("np.inf", "0.0"),
        f"{FRAGILE}/test_fragility_collapse.py::test_a_building_that_falls",
    ),
    Mutant(
        "collapse-of-a-neighbour",
        "the collapse of a building counts as that of its neighbour",
        "fell = True",
        f"{FALLEN}::test_a_building_does_not_inherit_the_collapse_of_its_neighbour_nor_a_storey_that_of_another",
    ),
    Mutant(
        "other-storeys",
        "the collapse of a storey counts as that of every storey of its building",
        (" and limit.level in (0, storey)", ""),
        f"{FRAGILE}/test_fragility_collapse.py::test_one_building_passes_what_its_collapsed_storey_passes",
    ),
    Mutant(
        "collapse-in-rounds",
        "a collapsed scene counts by the peaks it reached",
        "if True:",
        f"{FRAGILE}/test_fragility_collapse.py::test_a_building_that_falls",
    ),
    Mutant(
        "curve-of-undecided-motions",
        "a curve is fitted though half of the motions are undecided",
        ("2 * ", ""),
        f"{FRAGILE}/test_fragility_collapse.py::test_half_of_the_motions_undecided_give_no_curve",
    ),
    Mutant(
        "markers-of-undecided",
        "markers count undecided motions as holding at all intensities",
        ("(last >= x).sum()", "((last >= x) | np.isinf(passed)).sum()"),
        f"{FRAGILE}/test_fragility_collapse.py::test_markers_are_those_of_kaplan_and_meier",
    ),
    Mutant(
        "never-passed",
        "motions that never pass are left out of the likelihood",
        ("(low > 0) | ", ""),
        f"{FRAGILE}/test_likelihood.py::test_motions_that_never_passed_are_counted",
    ),
    Mutant(
        "counts-of-stripes",
        "motions that pass count as holding too",
        ("n - k", "n"),
        f"{FRAGILE}/test_likelihood.py::test_the_published_example_of_stripes",
    ),
    Mutant(
        "ends-of-a-band",
        "a band whose lower end leaves out twice as many draws",
        ("0.5 - confidence / 2", "0.5 - confidence / 4"),
        f"{FRAGILE}/test_bands.py::test_the_band_of_the_median_has_the_width_of_theory",
    ),
    Mutant(
        "paired-by-motion",
        "curves alone and with pounding rest on different draws of the motions",
        ("free, times,", "free, times[::-1],"),
        f"{FRAGILE}/test_fragility_runs.py::test_curves_alone_and_with_pounding_are_paired_by_motion",
    ),
]

MUTANTS: list[Mutant] = [
    *LINKS, *STOREYS, *MOTION, *ENERGY, *METHODS, *DESIGN, *GROUND, *OTHERS, *PRUNING, *HISTORIES, *GAPS, *FRAGILITY,
    *ANSWERS,
]  # fmt: skip
