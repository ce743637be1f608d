//! Properties of the equations: derivatives, roots, limits.

use pipeline::models::{chou_hannaford, hunt2017, new, tondu_lopez, values};
use pipeline::numerics::real::{Dual, Real};

/// Central difference of `f` in variable `k`.
fn central<const N: usize>(f: impl Fn([f64; N]) -> f64, at: [f64; N], k: usize) -> f64 {
    let h = 1e-5 * at[k].abs().max(1e-3);
    let (mut up, mut down) = (at, at);
    up[k] += h;
    down[k] -= h;
    (f(up) - f(down)) / (2.0 * h)
}

/// The gradient of `f` by dual numbers against central differences.
fn assert_gradient<const N: usize>(
    dual: impl Fn([Dual<N>; N]) -> Dual<N>,
    plain: impl Fn([f64; N]) -> f64,
    at: [f64; N],
) {
    let seeded = std::array::from_fn(|k| Dual::variable(at[k], k));
    let found = dual(seeded);
    assert!((found.value - plain(at)).abs() < 1e-9 * (1.0 + found.value.abs()));
    for k in 0..N {
        let expected = central(&plain, at, k);
        let miss = (found.gradient[k] - expected).abs();
        assert!(
            miss < 1e-6 * (1.0 + expected.abs()),
            "{k}: {} {expected}",
            found.gradient[k]
        );
    }
}

/// F(b1, b2, l_0, c0, c1, c2, l_rest, eps*, P*) of the new model.
fn new_force<R: Real>(x: [R; 9]) -> R {
    let [b1, b2, offset, c0, c1, c2, rest, eps, p] = x;
    new::force([c0, c1, c2], new::f620(b1, b2, offset, rest), eps, p)
}

#[test]
fn new_model_gradient_is_exact() {
    let at = [303.5, 19.03, 0.0075, 0.5682, 4.254, 0.5597, 0.182, 0.4, 0.8];
    assert_gradient(new_force, new_force, at);
    let fmax = [0.4895, 0.03068, 0.0075, 0.182, 300.0];
    assert_gradient(
        |[a1, a2, offset, rest, p]: [Dual<5>; 5]| new::fmax(a1, a2, offset, rest, p),
        |[a1, a2, offset, rest, p]| new::fmax(a1, a2, offset, rest, p),
        fmax,
    );
}

#[test]
fn where_the_surface_is_cut_off_its_gradient_is_zero() {
    let c = values(&new::PUBLISHED_10);
    let c: [Dual<3>; 3] = std::array::from_fn(|k| Dual::variable(c[6 + k], k));
    let cut = new::surface(c, Dual::constant(0.9), Dual::constant(0.3));
    assert_eq!((cut.value, cut.gradient), (0.0, [0.0; 3]));
    let signed = new::surface_signed(c, Dual::constant(0.9), Dual::constant(0.3));
    assert!(signed.value < 0.0 && signed.gradient.iter().all(|d| *d != 0.0));
}

/// F(p0, A, w, q, k, g, h, P, eps, eps_max) of Hunt's model while shortening.
fn hunt_force<R: Real>(x: [R; 10]) -> R {
    let [p0, a, w, q, k, g, h, p, eps, eps_max] = x;
    hunt2017::force([p0, a, w, q, k, g, h], p, eps, eps_max, 1.0)
}

#[test]
fn hunt_gradient_follows_the_implicit_function_theorem() {
    let c = values(&hunt2017::PUBLISHED_10);
    for (p, eps) in [(620.0, 0.084), (300.0, 0.042), (500.0, 0.12)] {
        let at = std::array::from_fn(|k| if k < 7 { c[k] } else { [p, eps, 0.168][k - 7] });
        assert_gradient(hunt_force, hunt_force, at);
    }
}

#[test]
fn hunt_root_gives_its_pressure_back() {
    let c = values(&hunt2017::PUBLISHED_10);
    let mut roots = 0;
    for i in 0..=40 {
        for k in 1..=32 {
            for (s, eps_max) in [(0.0, 0.168), (1.0, 0.25), (-1.0, 0.14)] {
                let (eps, p) = (f64::from(i) * 0.005, f64::from(k) * 25.0);
                let force = hunt2017::force(c, p, eps, eps_max, s);
                if force > 0.0 {
                    let back = hunt2017::pressure(c, force, eps, eps_max, s);
                    assert!((back - p).abs() < 1e-6 * p, "eps {eps} P {p} S {s}: {back}");
                    roots += 1;
                } else {
                    let slack = eps / eps_max > 1.236;
                    assert!(slack || hunt2017::pressure(c, 0.0, eps, eps_max, s) >= p);
                }
            }
        }
    }
    assert!(roots > 1500, "{roots}");
}

#[test]
fn hunt_force_falls_with_shortening_and_contraction() {
    let c = values(&hunt2017::PUBLISHED_10);
    let at = |eps, s| hunt2017::force(c, 500.0, eps, 0.168, s);
    for i in 1..=12 {
        let eps = f64::from(i) * 0.01;
        assert!(at(eps, -1.0) > at(eps, 0.0) && at(eps, 0.0) > at(eps, 1.0));
        assert!(at(eps, 0.0) < at(eps - 0.01, 0.0));
    }
}

#[test]
fn tondu_lopez_with_k_of_one_is_chou_and_hannaford() {
    for eps in [0.0, 0.1, 0.3] {
        let tondu = tondu_lopez::force(0.01, 0.4, 1.0, eps, 500.0);
        let chou = chou_hannaford::force_signed(0.01, 0.4, eps, 500.0);
        assert!((tondu - chou).abs() < 1e-9 * chou);
    }
    let k = tondu_lopez::amplification(0.4, 0.17);
    assert!(tondu_lopez::force(0.01, 0.4, k, 0.17, 620.0) < 1e-9);
    assert!(tondu_lopez::force(0.01, 0.4, k, 0.16, 620.0) > 0.0);
}
