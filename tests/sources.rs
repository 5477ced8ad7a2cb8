//! Invariants of the source files.

use std::fs;
use std::path::{Path, PathBuf};

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") && !path.ends_with("tests.rs") {
            found.push(path);
        }
    }
}

/// The part of a source file that is compiled into the library.
fn compiled(text: &str) -> &str {
    text.split("#[cfg(test)]\nmod tests {").next().unwrap()
}

#[test]
fn factorisations_are_taken_where_their_entries_are_tested() {
    const DIRECT: [&str; 20] = [
        ".lu()",
        ".qr()",
        ".svd(",
        ".cholesky()",
        ".symmetric_eigen()",
        ".symmetric_eigenvalues()",
        ".complex_eigenvalues()",
        ".schur()",
        ".hessenberg()",
        ".full_piv_lu()",
        ".col_piv_qr()",
        ".singular_values()",
        ".pseudo_inverse(",
        ".try_inverse()",
        "SymmetricEigen::new",
        "Cholesky::new",
        "LU::new",
        "SVD::new",
        "Schur::new",
        "QR::new",
    ];
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    sources(&root.join("src"), &mut files);
    sources(&root.join("crates"), &mut files);
    assert!(files.len() > 150);
    for path in files {
        let text = fs::read_to_string(&path).unwrap();
        let is_home = path.ends_with("numerics/src/factorization.rs");
        let in_tests = path.components().any(|part| part.as_os_str() == "tests");
        if is_home || in_tests {
            continue;
        }
        for direct in DIRECT {
            assert!(!compiled(&text).contains(direct), "{}: {direct}; use numerics::factorization", path.display());
        }
        // Those of faer work in place, behind a test of the entries.
        for in_place in ["factorize_numeric_llt(", "self_adjoint_evd("] {
            let tested = compiled(&text).contains("factorization::check(");
            assert!(!compiled(&text).contains(in_place) || tested, "{}: {in_place}", path.display());
        }
    }
}
