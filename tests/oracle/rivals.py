#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""Compute the voltages of control laws anew, in numpy and scipy, from the readings that test_rivals wrote.

    test_rivals FILE; rivals.py FILE

Written from the equations of the laws alone. Riccati equations are solved by scipy's solver, which uses eigenvalues, bounded least squares by
scipy's bvls. In every tick a law gets the recorded readings and voltages of the ticks before, so that differences do not add up. For the
linear quadratic Gaussian control also: spectral radius of the loop without limits on the exact model, from its eigenvalues. For positive
position feedback: decay of a mode, from the roots of the characteristic polynomial.
"""
import sys

import numpy as np
from scipy.linalg import solve_discrete_are
from scipy.optimize import lsq_linear

STEP, LEAKY, CLIPPED, LQG, LQG_BOUNDED, PPF, WISH, DAMPER = range(8)
NAMES = ['control step', 'leaky integrator', 'pseudo-inverse', 'LQG', 'LQG about the bounded optimum', 'positive position feedback',
         'damped wish', 'vibration damper']
NUMBERS = ('kind modes outputs inputs observed ticks delay interval step limit effort share regularisation gain leak weight ppf_modes feedback '
           'filter_ratio filter_frequency damping cut strength damper_cut mix follow kick drift slow governor').split()
RIDGE = 1e-7
DAMPED_TOLERANCE = 4e-3  # of the KKT violation, over the gradient at the last voltages, where a tick goes a part of the way or damps


def rivals(path):
    """Rivals of a dump, and the last record: a mode under position feedback."""
    data = np.fromfile(path)
    at = 0

    def take(*shape):
        nonlocal at
        count = int(np.prod(shape))
        at += count
        return data[at - count:at].reshape(shape)

    while data[at] >= 0:
        r = dict(zip(NUMBERS, take(len(NUMBERS))))
        for key in 'kind modes outputs inputs observed ticks delay ppf_modes'.split():
            r[key] = int(r[key])
        m, n, nu = r['outputs'], r['modes'], r['inputs']
        for key, shape in (('omega', (n,)), ('ratio', (n,)), ('shape', (m, n)), ('modal', (n, nu)), ('influence', (m, nu))):
            r[key] = take(*shape)
        r['tick'] = [(take(m), take(m), take(nu)) for _ in range(r['ticks'])]
        yield r
    yield dict(feedback=take(4)[1:], states=take((len(data) - at) // 4, 4))


def propagators(angle, ratio):
    """[modes][2][2] of (deviation, velocity over frequency) in a tick."""
    root, decay = np.sqrt(1 - ratio**2), np.exp(-ratio * angle)
    c, s = decay * np.cos(root * angle), decay * np.sin(root * angle) / root
    return np.moveaxis(np.array([[c + ratio * s, s], [-s, c - ratio * s]]), 2, 0)


class Model:
    """The modes that a law knows, and the static response."""

    def __init__(self, r):
        n = r['observed']
        self.n, self.nu, self.G, self.C, self.g = n, r['inputs'], r['influence'], r['shape'][:, :n], r['modal'][:n]
        self.angle, self.ratio, self.delay = r['omega'][:n] * r['interval'], r['ratio'][:n], r['delay']
        self.H = self.G.T @ self.G + r['effort'] * np.eye(self.nu)
        self.scale = np.trace(self.G.T @ self.G) / self.nu
        self.R = propagators(self.angle, self.ratio)
        i = np.arange(n)
        self.A, self.B = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, self.nu))
        for a in (0, 1):
            for b in (0, 1):
                self.A[a * n + i, b * n + i] = self.R[:, a, b]
        self.B[:n] = (1 - self.R[:, 0, 0])[:, None] * self.g
        self.B[n:] = -self.R[:, 1, 0][:, None] * self.g
        self.limit, self.step = r['limit'], r['step']

    def bounded(self, target, lower, upper):
        """Voltages inside bounds nearest to `target` in the norm of the Hessian."""
        root = np.linalg.cholesky(self.H).T
        lower, upper = np.minimum(lower, upper), np.maximum(upper, lower)
        if np.all(target >= lower) and np.all(target <= upper):
            return target
        tight = upper - lower < 1e-12 * self.limit
        return lsq_linear(root, root @ target, (lower - 1e-13 * tight, upper + 1e-13 * tight), method='bvls', tol=1e-15, max_iter=2000).x

    def box(self, v):
        return np.maximum(-self.limit, v - self.step), np.minimum(self.limit, v + self.step)

    def clip(self, v, last):
        return np.clip(np.clip(v, -self.limit, self.limit), last - self.step, last + self.step)


class Observer:
    """Kalman filter of positions, velocities and static positions under loads; the residual, low-passed."""

    def __init__(self, model, r):
        n, s = model.n, len(model.C)
        self.model, self.slow = model, r['slow']
        self.A, self.B = np.zeros((3 * n, 3 * n)), np.vstack([model.B, np.zeros((n, model.nu))])
        self.A[:2 * n, :2 * n] = model.A
        self.A[:n, 2 * n:], self.A[n:2 * n, 2 * n:] = np.diag(1 - model.R[:, 0, 0]), np.diag(-model.R[:, 1, 0])
        self.A[2 * n:, 2 * n:] = np.eye(n)
        fall = model.angle[0] / model.angle / np.sqrt(s)
        noise = np.diag(np.concatenate([np.full(n, 1e-12), (r['kick'] * fall)**2, (r['drift'] * fall)**2]))
        C = np.hstack([model.C, np.zeros((s, 2 * n))])
        P = solve_discrete_are(self.A.T, C.T, noise, np.eye(s))
        self.L = P @ C.T @ np.linalg.inv(C @ P @ C.T + np.eye(s))
        overlap = model.C.T @ model.C
        self.explain = np.linalg.solve(overlap + RIDGE * np.trace(overlap) / n * np.eye(n), model.C.T)
        self.late, self.residual = np.zeros(3 * n), np.zeros(s)
        self.past = [np.zeros(model.nu)] * (model.delay + 1)

    def tick(self, y, v):
        """Readings of `delay` ticks ago, voltages given since the last tick: state now, and the static shape under these voltages."""
        model, n = self.model, self.model.n
        self.past = self.past[1:] + [v]
        self.late = self.A @ self.late + self.B @ self.past[0]
        e = y - model.C @ self.late[:n] - (model.G - model.C @ model.g) @ self.past[0]
        self.late = self.late + self.L @ e
        self.residual = self.residual + self.slow * (e - self.residual)
        x = self.late
        for w in self.past[1:]:
            x = self.A @ x + self.B @ w
        rest = self.residual - model.C @ (self.explain @ self.residual)
        return x[:n], x[n:2 * n], x[2 * n:], model.G @ v + model.C @ x[2 * n:] + rest


def regulator(model, r):
    """Feedback of (q, p, v) to voltage changes, and the spectral radius of the loop without limits."""
    n, nu = model.n, model.nu
    A = np.block([[model.A, model.B], [np.zeros((nu, 2 * n)), np.eye(nu)]])
    B = np.vstack([model.B, np.eye(nu)])
    shape = np.hstack([model.C, np.zeros((len(model.C), n)), model.G - model.C @ model.g])
    Q = shape.T @ shape
    Q[2 * n:, 2 * n:] += r['effort'] * np.eye(nu)
    R = r['weight'] * model.scale * np.eye(nu)
    unit = model.scale  # scipy's solver wants matrices of the size of 1
    X = solve_discrete_are(A, B, Q / unit, R / unit) * unit
    K = np.linalg.solve(R + B.T @ X @ B, B.T @ X @ A)
    return K, np.abs(np.linalg.eigvals(A - B @ K)).max()


def violation(model, v, target, lower, upper):
    """KKT violation at the voltages v of the distance from `target` in the norm of the Hessian."""
    gradient, near = model.H @ (v - target), 1e-12 * model.limit
    inside = np.where(v <= lower + near, np.minimum(gradient, 0), np.where(v >= upper - near, np.maximum(gradient, 0), gradient))
    return np.abs(inside).max()


def voltages(r):
    """Largest difference of the voltages in any tick, over the limits or over the tolerance of the law, and facts to print."""
    model, kind, facts = Model(r), r['kind'], ''
    n, nu, G = model.n, model.nu, model.G
    observer = Observer(model, r) if kind in (LQG, LQG_BOUNDED, WISH, DAMPER) else None
    given = [np.zeros(nu)] * (model.delay + 1)  # voltages before the first tick, then those of every tick
    K, reference = None, np.zeros(nu)
    if kind in (LQG, LQG_BOUNDED):
        K, radius = regulator(model, r)
        facts = ', spectral radius %.6f without limits' % radius
        assert radius < 1, radius
    if kind == WISH:
        factors = np.linspace(0, 1, 201)
        best = []
        for R in model.R:
            sizes = []
            for x in factors:
                moved = R.copy()
                moved[:, 1] -= (np.array([1, 0]) - R[:, 0]) * x
                sizes.append(np.abs(np.linalg.eigvals(moved)).max())
            best.append(factors[np.argmax(np.array(sizes) <= min(sizes) + 1e-9)])
        fade = np.clip(2 - model.angle / r['cut'], 0, 1) if r['cut'] > 0 else 1
        delta = r['damping'] * fade * np.array(best)
    if kind == PPF:
        k = r['ppf_modes']
        F = propagators(model.angle[:k] * r['filter_frequency'], np.full(k, r['filter_ratio']))
        overlap = model.C.T @ model.C
        fit = np.linalg.solve(overlap + RIDGE * np.trace(overlap) / n * np.eye(n), model.C.T)[:k]
        pinv = np.linalg.pinv(model.g[:k])
        x, dx, d, fixed = np.zeros(k), np.zeros(k), np.zeros(len(G)), np.zeros(nu)
        fixed_past = [fixed] * (model.delay + 1)
    if kind == DAMPER:
        damping = r['strength'] * model.angle * np.clip(2 - model.angle / r['damper_cut'], 0, 1)
        before = np.zeros(n)
    out, early = [0], 0
    for z, y, recorded in r['tick']:
        v, old = given[-1], given[-1 - model.delay]
        if observer:
            q, p, w, static = observer.tick(y, v)
            target = np.linalg.solve(model.H, G.T @ (z - static + G @ v))
        if kind in (STEP, LEAKY, CLIPPED):
            now = y + G @ (v - old)
        if kind == STEP:
            gradient = model.H @ v - G.T @ (z - now + G @ v)
            wish = v - r['share'] * np.linalg.solve(model.H, gradient)
            new = model.bounded(wish, *model.box(v))
        elif kind == LEAKY:
            new = model.clip((1 - r['leak']) * v + r['gain'] * np.linalg.solve(model.H, G.T @ (z - now)), v)
        elif kind == CLIPPED:
            wide = model.H + r['regularisation'] * model.scale * np.eye(nu)
            new = model.clip(v + r['share'] * (np.linalg.solve(wide, G.T @ (z - now + G @ v)) - v), v)
        elif kind in (LQG, LQG_BOUNDED):
            if kind == LQG_BOUNDED:
                target = model.bounded(target, np.full(nu, -model.limit), np.full(nu, model.limit))
            move = np.zeros(nu)
            if r['governor'] > 0:
                way = model.bounded(np.linalg.solve(model.H, G.T @ z), np.full(nu, -model.limit), np.full(nu, model.limit)) - reference
                move = min(1, r['governor'] * model.step / max(np.abs(way).max(), 1e-300)) * way
                target, reference = target - way, reference + move
            state = np.concatenate([q - w - model.g @ target, p, v - target])
            new = model.clip(v + move - K @ state, v)
        elif kind == WISH:
            wish = np.linalg.solve(model.H, G.T @ (z - static + G @ v - model.C @ (delta * p)))
            new = model.bounded(wish, *model.box(v))
        elif kind == DAMPER:
            deviation = (1 - r['mix']) * (q - w - model.g @ v) + r['mix'] * (before - p) / model.angle
            before = p
            gradient = r['follow'] * model.H @ (v - target) - G.T @ model.C @ (damping * deviation)
            wish = v - np.linalg.solve(model.H, gradient)
            new = model.bounded(wish, *model.box(v))
        else:
            seen = y - G @ fixed_past[0] - d
            left = x - fit @ seen
            x, dx = fit @ seen + F[:, 0, 0] * left + F[:, 0, 1] * dx, F[:, 1, 0] * left + F[:, 1, 1] * dx
            d = d + r['gain'] * seen
            best = model.bounded(np.linalg.solve(model.H, G.T @ (z - d)), np.full(nu, -model.limit), np.full(nu, model.limit))
            fixed = fixed + np.clip(r['share'] * (best - fixed), -model.step, model.step)
            fixed_past = fixed_past[1:] + [fixed]
            new = model.clip(fixed + r['feedback'] * pinv @ x, v)
        if kind in (WISH, DAMPER) or kind == STEP and r['share'] < 1:
            most = DAMPED_TOLERANCE * np.abs(model.H @ (v - wish)).max()
            early = max(early, violation(model, recorded, wish, *model.box(v)) / most)
        else:
            out.append(np.abs(new - recorded).max() / model.limit)
        given.append(recorded)
    return max(out), early, facts


def feedback_loop(gain, ratio, angle):
    """Matrix of a tick of a mode without damping of its own under position feedback: position and velocity of the mode, then of the filter."""
    mode, filtered = propagators(np.array([angle, angle]), np.array([0, ratio]))
    loop = np.zeros((4, 4))
    loop[2:, 2:], loop[2:, 0] = filtered, np.array([1, 0]) - filtered[:, 0]
    loop[:2, :2] = mode
    loop[:2] += np.outer(np.array([1, 0]) - mode[:, 0], gain * loop[2])
    return loop


def main():
    number, failed = 0, False
    for r in rivals(sys.argv[1]):
        number += 1
        if 'kind' in r:
            most, early, facts = voltages(r)
            good = most < 1e-10 and early <= 1
            close = 'at most %.2f of the allowed KKT violation' % early if early else 'voltages within %.1e of the limits' % most
            said = '%s: %s in %d ticks%s' % (NAMES[r['kind']], close, r['ticks'], facts)
        else:
            gain, ratio, angle = r['feedback']
            loop, states = feedback_loop(gain, ratio, angle), r['states']
            wrong = np.abs(states[1:] - states[:-1] @ loop.T).max() / np.abs(states).max()
            sampled = -np.log(np.abs(np.linalg.eigvals(loop)).max()) / angle
            exact = -np.roots([1, 2 * ratio, 2, 2 * ratio, 1 - gain]).real.max()
            good = wrong < 1e-6 and abs(sampled - exact) < angle * exact
            said = ('positive position feedback: a mode moves as its loop matrix says within %.1e, decay a radian %.4f, of the continuous loop %.4f'
                    % (wrong, sampled, exact))
        failed |= not good
        print('%s %d - %s' % ('ok' if good else 'not ok', number, said))
    sys.exit(failed)


main()
