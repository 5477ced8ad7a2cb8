//! Properties of a machine that the bits of the results depend on.
//!
//! Three things: how the C library computes exp, sin, pow and so on (it chooses by processor), how wide the vectors are in
//! which products of matrices are summed up, and in which blocks they are (by the sizes of the caches). Each shows in
//! the bits of a probe. Vectors wider than those of AVX2 are not used. The number of threads does not matter: nothing here
//! uses more than one.

use super::record::hash;
use nalgebra::DMatrix;
use scene::fnv::Fnv;
use std::hint::black_box;

/// The present machine in one line.
pub(crate) fn describe() -> String {
    format!(
        "{}-{}, {}, functions {:016x}, products {:016x}",
        std::env::consts::ARCH,
        std::env::consts::OS,
        vector_units(),
        functions().0,
        products().0
    )
}

#[cfg(target_arch = "x86_64")]
fn vector_units() -> String {
    let known = [
        ("avx", std::arch::is_x86_feature_detected!("avx")),
        ("avx2", std::arch::is_x86_feature_detected!("avx2")),
        ("fma", std::arch::is_x86_feature_detected!("fma")),
    ];
    let names: Vec<&str> = known.iter().filter(|unit| unit.1).map(|unit| unit.0).collect();
    if names.is_empty() { "sse2".to_owned() } else { names.join(" ") }
}

#[cfg(not(target_arch = "x86_64"))]
fn vector_units() -> String {
    "vectors of the architecture".to_owned()
}

/// Mathematical functions over arguments of many sizes.
fn functions() -> Fnv {
    hash((0..4000_u32).flat_map(|index| {
        let x = black_box(1e-6 * 1.007_f64.powi(index as i32 % 3000) + f64::from(index) * 1e-4);
        [x.sin(), x.cos(), (-x).exp(), x.ln(), x.powf(0.8), x.tanh(), x.atan(), (-x).exp_m1(), x.ln_1p(), x.cbrt()]
    }))
}

/// Products of matrices of the sizes that contact lines have, by both libraries.
fn products() -> Fnv {
    let mut values = Vec::new();
    for n in [9, 33, 129, 400] {
        let entry = |row: usize, column: usize| black_box(1.0 / (1.0 + row as f64 + 0.37 * column as f64));
        let (left, right) = (DMatrix::from_fn(n, n, entry), DMatrix::from_fn(n, n, |i, j| entry(j, i + 1)));
        values.extend((&left * &right).iter());
        let (left, right) = (faer::Mat::from_fn(n, n, entry), faer::Mat::from_fn(n, n, |i, j| entry(j, i + 1)));
        let product = &left * &right;
        values.extend((0..n).flat_map(|column| (0..n).map(move |row| (row, column))).map(|place| product[place]));
    }
    hash(values)
}
