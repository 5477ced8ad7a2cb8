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

/// Numbers of the sections that the last line of a module's head names: `Theory: docs/theory.md, sections 6.8, 4.11.`
fn sections(text: &str) -> Vec<String> {
    let head = text.lines().take_while(|line| line.starts_with("//!"));
    let named = head.filter_map(|line| line.strip_prefix("//! Theory: docs/theory.md, section")).last();
    let numbers = named.map(|rest| rest.trim_start_matches('s').trim().trim_end_matches('.'));
    numbers.into_iter().flat_map(|numbers| numbers.split(", ")).map(str::to_owned).collect()
}

#[test]
fn every_module_of_the_physics_names_sections_of_the_theory_that_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let theory = fs::read_to_string(root.join("docs/theory.md")).unwrap();
    let exists = |number: &String| {
        let heading = |line: &str| line.trim_start_matches('#').trim_start().split(' ').next().map(str::to_owned);
        let headings = theory.lines().filter(|line| line.starts_with("##")).filter_map(heading);
        headings.map(|found| found.trim_end_matches('.').to_owned()).any(|found| found == *number)
    };
    let mut faults = Vec::new();
    for layer in ["numerics", "scene", "elasticity", "conduction", "contact", "model", "steady"] {
        let mut files = Vec::new();
        sources(&root.join("crates").join(layer).join("src"), &mut files);
        assert!(!files.is_empty(), "{layer}");
        for path in files.iter().filter(|path| !path.components().any(|part| part.as_os_str() == "tests")) {
            let named = sections(&fs::read_to_string(path).unwrap());
            // Tools of linear algebra and the table of variables carry no equation of the model.
            let needs = !["numerics", "scene"].contains(&layer);
            if named.is_empty() && needs {
                faults.push(format!("{}: its head names no section of docs/theory.md", path.display()));
            }
            let unknown = named.iter().filter(|number| !exists(number));
            faults.extend(unknown.map(|number| format!("{}: docs/theory.md has no section {number}", path.display())));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
