"""The pair of docs/from-opensees.md in OpenSeesPy: two buildings of five storeys in touch, under El Centro."""

import time

import numpy as np
import openseespy.opensees as ops

STOREYS, MASS, HEIGHT = 5, 200e3, 3.0  # -, kg, m
G = 9.80665  # m/s2
RESTITUTION, DAMPING, HARDENING = 0.5, 0.05, 0.05


def stiffness(period):
    """Storey stiffnesses [N/m], linear to a third at the top, and alpha, beta for 5 % in modes 1 and 2."""
    k = np.linspace(1, 1 / 3, STOREYS)
    shape = np.diag(k + np.append(k[1:], 0)) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
    squares = np.linalg.eigvalsh(shape)
    factor = (2 * np.pi / period) ** 2 / squares[0]
    one, two = np.sqrt(factor * squares[:2])
    return factor * MASS * k, 2 * DAMPING * one * two / (one + two), 2 * DAMPING / (one + two)


def yield_shears(period):
    """UBC 1991, Z 0.4, S 1.2, Rw 12, period below 0.7 s."""
    base = 0.4 * min(1.25 * 1.2 / period ** (2 / 3), 2.75) / 12 * STOREYS * MASS * G
    floors = np.arange(1, STOREYS + 1)
    return base * np.cumsum(floors[::-1])[::-1] / floors.sum()


def march(dt, inelastic):
    """Peak storey shears [N], 0.36 s building first, and the seconds spent stepping."""
    ops.wipe()
    ops.logFile("opensees.log", "-noEcho")
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    floors, storeys, stiffest = [], [], 0.0
    for place, period in enumerate((0.36, 0.60)):
        k, alpha, beta = stiffness(period)
        stiffest = max(stiffest, k[0])
        base = 100 * place
        ops.node(base, 0.0)
        ops.fix(base, 1)
        for j in range(STOREYS):
            node = base + j + 1
            ops.node(node, 0.0)
            ops.mass(node, MASS)
            if inelastic:
                ops.uniaxialMaterial("Steel01", node, yield_shears(period)[j], k[j], HARDENING)
            else:
                ops.uniaxialMaterial("Elastic", node, k[j])
            ops.element("zeroLength", node, node - 1, node, "-mat", node, "-dir", 1, "-doRayleigh", 1)
        nodes = list(range(base + 1, base + STOREYS + 1))
        ops.region(2 * place + 1, "-node", *nodes, "-rayleigh", alpha, 0.0, beta, 0.0)
        ops.region(2 * place + 2, "-ele", *nodes, "-rayleigh", alpha, 0.0, beta, 0.0)
        floors.append(nodes)
        storeys += nodes
    impact = 20 * stiffest
    xi = -np.log(RESTITUTION) / np.hypot(np.pi, np.log(RESTITUTION))
    dashpot = 2 * xi * np.sqrt(impact * MASS / 2)  # eq. (7) with m1 m2 / (m1 + m2)
    for j, (left, right) in enumerate(zip(*floors, strict=True)):
        ops.uniaxialMaterial("ViscoelasticGap", 1001 + j, impact, dashpot, 0.0)
        ops.element("zeroLength", 1001 + j, left, right, "-mat", 1001 + j, "-dir", 1)
    ground = np.loadtxt("records/elcentro.txt") * G  # every 0.01 s, in g
    ops.timeSeries("Path", 1, "-dt", 0.01, "-values", *ground, "-useLast")
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    ops.recorder("EnvelopeElement", "-file", "peaks.out", "-precision", 16, "-ele", *storeys, "material", 1, "stress")
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("ProfileSPD")
    ops.test("NormUnbalance", 1e-3, 50, 0)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    begin = time.perf_counter()
    failed = ops.analyze(round(10.0 / dt), dt)
    seconds = time.perf_counter() - begin
    reached = ops.getTime()
    ops.wipe()  # closes the recorder's file
    if failed:
        raise RuntimeError(f"OpenSees failed at {reached:g} s of 10 s")
    return np.loadtxt("peaks.out")[2], seconds
