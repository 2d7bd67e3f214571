import math

import numpy as np
import pytest
from scipy import stats
from scipy.signal import lfilter

from gaspart.analysis import statistics
from gaspart.analysis.estimate import Estimate
from gaspart.analysis.statistics.blocks import ORDER


def test_correlated_mean_reports_a_series_that_is_too_short():
    result = statistics.correlated_mean(np.cumsum(np.random.default_rng(3).standard_normal(256)))
    assert not result.flat
    assert result.block_length == 16


SERIES = {
    "independent": ([1.0], [1.0], (20, 40, 80, 200)),
    "anticorrelated": ([1.0], [1.0, 0.3], (40, 80, 200)),
    "alternating": ([1.0], [1.0, 0.7], (200,)),
    "oscillating": ([1.0], [1.0, -1.2, 0.6], (200,)),
    "differences": ([1.0, -0.5], [1.0], (200,)),
    "short memory": ([1.0], [1.0, -0.5], (40, 200)),
    "memory": ([1.0], [1.0, -0.72], (200,)),
    "long memory": ([1.0], [1.0, -0.9], (1000,)),
}
"""Filters of white noise (numerator, denominator), and numbers of samples."""


@pytest.mark.parametrize(
    ("kind", "size"), [(kind, size) for kind, (_, _, sizes) in SERIES.items() for size in sizes]
)
def test_deviations_over_errors_follow_student(kind, size):
    """As Gaussian deviations of the same probability; errors from blocks alone make them 1.1 to 1.4 wide."""
    rng, scattered = np.random.default_rng(5), 1500
    deviations = []
    for noise in rng.standard_normal((scattered, size + 100)):
        series = lfilter(*SERIES[kind][:2], noise)[100:]
        deviations.append(statistics.correlated_mean(series).estimate.deviation)
    width = np.sqrt(np.mean(np.square(deviations)))
    assert width == pytest.approx(1.0, abs=0.06)  # 3 / sqrt(2 * 1500), and the freedom is an estimate
    assert np.mean(np.abs(deviations) > 3.0) < 0.01


@pytest.mark.parametrize(
    "memory", [-0.6, 0.9, *(pytest.param(x, marks=pytest.mark.thorough) for x in (-0.9, -0.5, 0.0, 0.5))]
)
def test_the_correlation_time_of_a_markov_series(memory):
    """(1 + m) / (1 - m) of twice the time, below 1 for an anticorrelated series, which holds more independent
    values than samples."""
    series = np.random.default_rng(1).standard_normal((20, 20500))
    found = [
        2.0 * statistics.autocorrelation_time(lfilter([1.0], [1.0, -memory], one)[500:]) for one in series
    ]
    assert np.mean(found) == pytest.approx((1.0 + memory) / (1.0 - memory), rel=0.05)
    assert statistics.autocorrelation_time(np.full(10, 3.0)) == 0.5


@pytest.mark.parametrize(
    ("period", "decay"),
    [
        (50, 0.98),
        (100, 0.99),
        *(pytest.param(*x, marks=pytest.mark.thorough) for x in ((20, 0.97), (200, 0.995))),
    ],
)
@pytest.mark.parametrize("white", [0.0, 1.0])
def test_the_correlation_time_of_an_oscillation_longer_than_the_order_of_the_fit(period, decay, white):
    """Of an autoregressive series of order 2, and of the same beside as much white noise, which hides
    a period of six times the order: the time is then too long, and the error too large by less than 2."""
    first, second = 2.0 * decay * math.cos(2.0 * math.pi / period), -(decay**2)
    variance = (1.0 - second) / ((1.0 + second) * ((1.0 - second) ** 2 - first**2))
    exact = 1.0 / (1.0 - first - second) ** 2 / variance
    rng, found = np.random.default_rng(2), []
    for noise in rng.standard_normal((20, 24000)):
        one = lfilter([1.0], [1.0, -first, -second], noise)[4000:] / math.sqrt(variance)
        one += math.sqrt(white) * rng.standard_normal(one.size)
        found.append(2.0 * statistics.autocorrelation_time(one))
    exact = (exact + white) / (1.0 + white)
    hidden = white > 0.0 and period > 5.0 * ORDER * 20000 ** (1.0 / 3.0)
    assert 0.9 * exact < np.mean(found) < (4.0 if hidden else 1.1) * exact


@pytest.mark.parametrize("period", [2.0, 7.3, 30.0, 100.0])
def test_the_error_of_a_periodic_series_is_never_too_small_and_falls_faster_than_the_root(period):
    """The mean of a sine of amplitude 1 over n samples is off by 1 / (pi n / period) at most."""
    errors = []
    for size in (2**10, 2**16):
        series = np.sin(2.0 * math.pi * np.arange(size) / period + 0.3)
        errors.append(statistics.correlated_mean(series).estimate.error)
        assert abs(series.mean()) < 2.0 * errors[-1] + 1e-12
    assert errors[1] < errors[0] / 12.0  # 64 times as long


@pytest.mark.parametrize("period", [40, 200, 1000])
def test_a_square_wave_has_no_more_freedom_than_it_has_jumped(period):
    series = 1.0 + (np.arange(3, 96) % period < period // 2)
    found = statistics.correlated_mean(series).estimate
    assert found.freedom <= max(1, np.count_nonzero(np.diff(series)))


def test_what_is_the_same_to_rounding_tells_no_error():
    found = statistics.correlated_mean(0.3 * np.diff(np.cumsum(np.full(100, 0.1)))).estimate
    assert (found.error, found.freedom) == (0.0, 1.0)


def free_particles(rng, number, length, duration):
    """Numbers of free particles of mean `number` in a slit between reservoirs, every half unit of time: those
    that are inside at first, and those that enter, each at a speed of the flux of a Maxwell distribution."""
    first = rng.poisson(number)
    velocities, ways = rng.standard_normal(first), length * rng.random(first)
    entering = rng.poisson(number / length * math.sqrt(2.0 / math.pi) * duration)
    entries = duration * rng.random(entering)
    exits = entries + length / np.sqrt(2.0 * rng.exponential(size=entering))
    times = np.arange(0.5, duration, 0.5)
    entered = first + np.searchsorted(np.sort(entries), times)
    left = np.concatenate([ways / np.abs(velocities), exits])
    return (entered - np.searchsorted(np.sort(left), times)).astype(float)


@pytest.mark.parametrize(
    ("length", "duration", "most"), [(4.0, 200.0, 1.3), (4.0, 1000.0, 1.2), (10.0, 1000.0, 1.25)]
)
def test_the_number_of_free_particles_has_an_error_that_covers_slow_ones(length, duration, most):
    """Their correlations fall as 1 / t. The width of 400 deviations is known to 3.5 %."""
    rng, slow, plain = np.random.default_rng(11), [], []
    for _ in range(400):
        series = free_particles(rng, 20.0, length, duration)
        for found, kept in (
            (statistics.slow_mean(series), slow),
            (statistics.correlated_mean(series).estimate, plain),
        ):
            kept.append(Estimate(found.value - 20.0, found.error, found.freedom).deviation)
    width, before = (float(np.sqrt(np.mean(np.square(one)))) for one in (slow, plain))
    assert 0.93 < width < most and before > 1.25
    assert np.mean(np.abs(slow) > 3.0) < 0.015


def test_without_a_tail_the_error_is_that_of_other_series():
    errors = []
    for seed in range(200):
        noise = np.random.default_rng(seed).standard_normal(1100)
        series = lfilter([1.0], [1.0, -0.7], noise)[100:]
        errors.append([statistics.slow_mean(series).error, statistics.correlated_mean(series).estimate.error])
    slow, plain = np.array(errors).T
    assert 1.0 <= np.mean(slow / plain) < 1.25


def test_means():
    estimate = statistics.mean_of([1.0, 2.0, 3.0])
    assert estimate.value == 2.0
    assert estimate.error == pytest.approx(1.0 / math.sqrt(3.0))
    combined = statistics.combine([1.0, 3.0], [1.0, 2.0])
    assert combined.value == pytest.approx(1.4)
    assert combined.error == pytest.approx(1.0 / math.sqrt(1.25))
    assert combined.chi_square == pytest.approx(0.8)
    assert combined.p_value == pytest.approx(stats.chi2.sf(0.8, 1))
    assert math.isnan(statistics.combine([1.0], [1.0]).p_value)


def test_polynomial_fit_recovers_coefficients_within_their_errors():
    generator = np.random.default_rng(5)
    x = np.linspace(0.01, 0.3, 25)
    truth, error = np.array([2.0, 3.128, 4.26]), 1e-3
    fits = []
    for _ in range(300):
        y = x * truth[0] + x**2 * truth[1] + x**3 * truth[2] + error * generator.standard_normal(x.size)
        fits.append(statistics.fit_polynomial(x, y, error, powers=(1, 2, 3)))
    pulls = np.array([(fit.values - truth) / fit.errors for fit in fits])
    assert np.all(np.abs(pulls.mean(axis=0)) < 0.25)
    assert np.all(np.abs(pulls.std(axis=0) - 1.0) < 0.15)
    assert stats.kstest([fit.p_value for fit in fits], "uniform").pvalue > 1e-3
    # The full covariance: a combination of the parameters has its own right error.
    combination = np.array([1.0, 0.1, 0.01])
    pulls = [
        combination @ (fit.values - truth) / np.sqrt(combination @ fit.covariance @ combination)
        for fit in fits
    ]
    assert abs(np.std(pulls) - 1.0) < 0.15


@pytest.mark.parametrize("powers", [(0,), (0, 1, 2)])
def test_a_fit_to_errors_from_a_few_samples_has_their_degrees_of_freedom(powers):
    """Five points of eight samples each, as the vibrated bed: with errors taken as exact, the deviations are
    1.2 to 1.35 wide, and 2 to 3 % of them beyond 3."""
    generator = np.random.default_rng(13)
    x, error = np.array([0.03, 0.06, 0.12, 0.3, 0.6]), np.array([3.5, 5.0, 4.0, 4.0, 4.0])
    fits = []
    for _ in range(2000):
        samples = error[:, None] * generator.standard_normal((5, 8))
        own = samples.std(axis=1, ddof=1) / math.sqrt(8)
        fits.append(statistics.fit_polynomial(x, samples.mean(axis=1), own, powers=powers, freedoms=7))
    found = np.array([fit.estimate(0).deviation for fit in fits])
    assert np.sqrt(np.mean(found**2)) == pytest.approx(1.0, abs=0.06)
    assert np.mean(np.abs(found) > 3.0) < 0.0125
    assert 7.0 <= np.median([fit.freedoms[0] for fit in fits]) <= 35.0
    assert stats.kstest([fit.p_value for fit in fits], "uniform").pvalue > 1e-3


def test_fixed_terms_are_subtracted():
    x = np.linspace(0.1, 1.0, 9)
    y = 1.0 + 2.0 * x + 3.0 * x**2
    fit = statistics.fit_polynomial(x, y, 0.1, powers=(1,), fixed={0: 1.0, 2: 3.0})
    assert fit.values == pytest.approx([2.0])
    assert fit.degrees_of_freedom == 8
    assert fit.chi_square == pytest.approx(0.0, abs=1e-20)


def test_fit_without_errors_takes_them_from_the_scatter():
    generator = np.random.default_rng(6)
    x = np.linspace(0.0, 1.0, 200)
    y = 1.0 + x + 0.05 * generator.standard_normal(x.size)
    known = statistics.fit_polynomial(x, y, 0.05)
    guessed = statistics.fit_polynomial(x, y)
    np.testing.assert_allclose(guessed.values, known.values, rtol=1e-10)
    np.testing.assert_allclose(guessed.errors, known.errors, rtol=0.15)
    assert math.isnan(guessed.p_value)


def test_power_law():
    x = np.array([10.0, 100.0, 1e3, 1e4])
    law = statistics.fit_power_law(x, 3.0 * x**1.5, 0.01 * 3.0 * x**1.5)
    assert law.exponent == pytest.approx(1.5, rel=1e-12)
    assert law.amplitude == pytest.approx(3.0, rel=1e-10)
    spread = np.sqrt(np.sum((np.log(x) - np.log(x).mean()) ** 2))
    assert law.exponent_error == pytest.approx(0.01 / spread)
    assert law.amplitude_error == pytest.approx(
        3.0 * 0.01 * math.sqrt(0.25 + np.log(x).mean() ** 2 / spread**2), rel=1e-10
    )


def test_histogram_probabilities_are_uniform():
    generator = np.random.default_rng(9)
    values = [
        statistics.histogram_chi_square(generator.uniform(size=2000), lambda u: u, 20).p_value
        for _ in range(300)
    ]
    assert stats.kstest(values, "uniform").pvalue > 1e-3


def test_bootstrap_of_a_mean_is_its_standard_error():
    samples = np.random.default_rng(10).standard_normal(400)
    estimate = statistics.bootstrap(np.mean, samples)
    assert estimate.value == samples.mean()
    assert estimate.error == pytest.approx(samples.std() / 20.0, rel=0.1)
    assert statistics.bootstrap(np.mean, samples) == estimate


def test_jackknife_of_a_ratio_includes_correlations():
    generator = np.random.default_rng(11)
    common, own = generator.normal(10.0, 1.0, 400), generator.normal(0.0, 0.1, (400, 3))
    value, error = statistics.jackknife(lambda a, b: a / b, common[:, None] + own, common)
    assert value == pytest.approx(np.ones(3), abs=5e-3)
    assert error == pytest.approx(np.full(3, 0.01 / 20.0), rel=0.15)
    mean, spread = statistics.jackknife(lambda a: a, common)
    assert (mean, spread) == (common.mean(), pytest.approx(common.std(ddof=1) / 20.0))
    with pytest.raises(ValueError, match="blocks"):
        statistics.jackknife(lambda a, b: a, common, common[:5])


def test_optimum_of_a_cost_of_two_terms():
    # Cost of pair tests and of box visits: a / x + b x, least at sqrt(a / b).
    generator = np.random.default_rng(12)
    x = np.geomspace(2.0, 32.0, 13)
    inside = 0
    for _ in range(200):
        cost = (64.0 / x + x) * (1.0 + 0.02 * generator.standard_normal(x.size))
        best = statistics.optimum(x, cost)
        assert best.interior
        assert best.low < best.location < best.high
        inside += best.low <= 8.0 <= best.high
        assert best.cost == pytest.approx(16.0, rel=0.06)
        for edge in (best.flat_low, best.flat_high):
            assert 64.0 / edge + edge == pytest.approx(16.8, rel=0.05)
    assert 180 <= inside <= 199  # 95 %


def test_a_minimum_at_the_edge_is_not_an_optimum():
    x = np.geomspace(1.0, 100.0, 9)
    best = statistics.optimum(x, 1.0 / x, within=1e3)
    assert not best.interior
    assert (best.location, best.low, best.high) == (pytest.approx(100.0), 0.0, math.inf)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: statistics.mean_of([1.0]), "at least 2"),
        (lambda: statistics.mean_of([1.0, math.nan]), "not all values are finite"),
        (lambda: statistics.combine([1.0, 2.0], [1.0, 0.0]), "errors: must be positive"),
        (lambda: statistics.correlated_mean(np.ones(8)), "at least 16"),
        (lambda: statistics.fit_polynomial([1.0, 2.0], [1.0, 2.0, 3.0]), "2 and 3 values"),
        (lambda: statistics.fit_polynomial([1.0, 2.0], [1.0, 2.0], powers=(0, 1)), "too few"),
        (lambda: statistics.fit_polynomial([1.0, 1.0, 1.0], [1.0, 2.0, 3.0], 0.1), "not independent"),
        (lambda: statistics.combine([1.0, 2.0], [1.0, 1.0], 0.0), "freedoms: must be positive"),
        (lambda: statistics.fit_power_law([1.0, -2.0, 3.0], [1.0, 2.0, 3.0]), "positive"),
        (lambda: statistics.histogram_chi_square(np.ones(9), lambda u: u, 2), "5 or more"),
        (lambda: statistics.optimum([1.0, 2.0, 3.0], [3.0, 2.0, 3.0]), "at least 4"),
    ],
)
def test_unusable_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_the_mean_of_a_current_through_a_store_is_as_certain_as_it_is():
    """A current of white noise, part of which is stored: blocks that store more give it back."""
    generator = np.random.default_rng(21)
    deviations, plain = [], []
    for _ in range(300):
        stored = 5.0 * generator.standard_normal(21)
        current = 1.0 + 0.3 * generator.standard_normal(20) + np.diff(stored)
        found = statistics.steady_mean(current, np.diff(stored))
        assert found.freedom == 18.0
        deviations.append((found.value - 1.0) / found.error)
        plain.append((current.mean() - 1.0) / statistics.mean_of(current).error)
    assert np.mean(np.square(deviations)) == pytest.approx(18.0 / 16.0, abs=3.0 * 1.8 / 300**0.5)  # Student's
    assert np.mean(np.square(plain)) < 0.2
    nothing = np.zeros(20)
    assert statistics.steady_mean(current, nothing).freedom == 19.0


def test_means_of_groups_count_what_is_in_them_alike():
    """However things are divided, their mean is the same; the error is theirs, on average."""
    generator = np.random.default_rng(4)
    sizes = [1, 1, 1, 5, 2, 2, 7, 1]
    ends = np.cumsum(sizes)[:-1]
    ratios = []
    for _ in range(4000):
        things = generator.normal(size=sum(sizes))
        value, error = statistics.means_of([part.mean() for part in np.split(things, ends)], sizes)
        assert value == pytest.approx(things.mean())
        ratios.append(error**2 * sum(sizes))
    assert np.mean(ratios) == pytest.approx(1.0, abs=3.0 * np.std(ratios) / math.sqrt(len(ratios)))
    assert statistics.means_of([1.0, 3.0], [4, 4])[1] == statistics.means_of([1.0, 3.0])[1]


@pytest.mark.parametrize("error", [0.0, np.nan, np.inf])
def test_a_curve_fit_refuses_errors_that_are_not_positive(error):
    x, errors = np.linspace(0.1, 2.0, 20), np.full(20, 0.01)
    values = 3.0 * np.exp(-x)

    def law(x, amplitude, rate):
        return amplitude * np.exp(-rate * x)

    found, covariance = statistics.fit_curve(law, x, Estimate(values, errors), (1.0, 2.0))
    assert found == pytest.approx([3.0, 1.0])
    doubled = statistics.fit_curve(law, x, Estimate(values, 2.0 * errors), (1.0, 2.0))[1]
    assert doubled == pytest.approx(4.0 * covariance, rel=1e-3)
    errors[7] = error
    with pytest.raises(ValueError, match="positive and finite"):
        statistics.fit_curve(law, x, Estimate(values, errors), (1.0, 2.0))
