use super::boundary::{contact_cells, contact_integrals};
use super::*;
use faer::Mat;
use nalgebra::{DMatrix, DVector};

const SQUARE: BlockProperties = BlockProperties { width: 2.0, height: 2.0, youngs_modulus: 1.0, poissons_ratio: 0.3 };

/// Boundaries of `count` cells, graded to both edges.
fn graded_cells(count: usize, half_width: f64) -> Vec<f64> {
    (0..=count).map(|i| half_width * (std::f64::consts::PI * (i as f64 / count as f64 - 0.5)).sin()).collect()
}

fn widths(boundaries: &[f64]) -> DVector<f64> {
    DVector::from_iterator(boundaries.len() - 1, boundaries.windows(2).map(|pair| pair[1] - pair[0]))
}

#[test]
fn linear_displacements_are_exact() {
    // Patch test: uniform stress, its tractions on sides and contact, its displacements at the top.
    let block = Block::new(SQUARE, Discretization::uniform(4, 3)).unwrap();
    let lambda = SQUARE.lambda_over_shear();
    let gradient = [[0.3, -0.7], [0.2, 0.5]];
    let displacement = |x: f64, z: f64, component: usize| gradient[component][0] * x + gradient[component][1] * z;
    let volume = gradient[0][0] + gradient[1][1];
    let stress = |i: usize, k: usize| gradient[i][k] + gradient[k][i] + if i == k { lambda * volume } else { 0.0 };
    let mesh = &block.mesh;
    let mut loads = Mat::zeros(block.degrees(), 1);
    // Integrals over an edge: half its size for each vertex, -sqrt(2/3) times half its size for the quadratic function.
    let edge_integrals = [1.0, 1.0, -(2.0f64 / 3.0).sqrt()];
    let mut apply = |degrees: Vec<usize>, size: f64, normal: (f64, f64)| {
        for (&degree, integral) in degrees.iter().zip(edge_integrals).filter(|&(&d, _)| d < mesh.free) {
            for i in 0..2 {
                let traction = stress(i, 0) * normal.0 + stress(i, 1) * normal.1;
                loads[(2 * degree + i, 0)] += 0.5 * size * integral * traction;
            }
        }
    };
    for row in 0..mesh.z.intervals() {
        apply(mesh.vertical_degrees(row, false), mesh.z.size(row), (-1.0, 0.0));
        apply(mesh.vertical_degrees(row, true), mesh.z.size(row), (1.0, 0.0));
    }
    for column in 0..mesh.x.intervals() {
        apply(mesh.horizontal_degrees(column, false), mesh.x.size(column), (0.0, -1.0));
    }
    let expected = |component: usize| -> Vec<f64> {
        let mut values = vec![0.0; mesh.total];
        for entity in &mesh.entities {
            if let Some((x, z)) = mesh.vertex(entity) {
                values[entity.first] = displacement(x, z, component);
            }
        }
        values
    };
    let exact = [expected(0), expected(1)];
    let held = Mat::from_fn(2 * (mesh.total - mesh.free), 1, |i, _| exact[i % 2][mesh.free + i / 2]);
    block.pattern.subtract_held(&block.mesh, &block.elements, &block.kind, &mut loads, &held);
    block.solve_in_place(&mut loads).unwrap();
    for i in 0..block.degrees() {
        assert!((loads[(i, 0)] - exact[i % 2][i / 2]).abs() < 1e-11, "degree of freedom {i}");
    }
}

#[test]
fn energy_error_falls_exponentially_with_the_order() {
    let pressure = |x: f64| (1.5 * x).cos() + x;
    let reference = Block::new(SQUARE, Discretization::uniform(11, 8)).unwrap().strain_energy(pressure).unwrap();
    for layers in [5, 6] {
        let mut previous = 1.0;
        for order in 1..=8 {
            let block = Block::new(SQUARE, Discretization::uniform(order, layers)).unwrap();
            let error = (reference - block.strain_energy(pressure).unwrap()).abs() / reference;
            assert!(error < previous / 3.0, "{layers} layers, order {order}: {error:e} after {previous:e}");
            previous = error;
        }
        assert!(previous < 1e-7, "{layers} layers, order 8: {previous:e}");
    }
    // Too few layers leave the corner unresolved at every order.
    let coarse = Block::new(SQUARE, Discretization::uniform(8, 2)).unwrap().strain_energy(pressure).unwrap();
    assert!((reference - coarse).abs() / reference > 1e-6);
}

#[test]
fn compliance_is_that_of_elements_refined_at_every_pressure_jump() {
    // The plain method: no half-plane, every cell boundary an element boundary with layers of its own.
    let boundaries = [-1.0, -0.7, 0.1, 1.0];
    let z = Division { first_layers: 7, last_layers: 5, grading: 0.15, largest: 2.0 };
    let mut points = vec![-1.0];
    for cell in boundaries.windows(2) {
        let division = Division { first_layers: 7, last_layers: 7, ..z };
        points.extend_from_slice(&Grid::graded(cell[0], cell[1], division, 6).points[1..]);
    }
    let x = Grid { orders: vec![6; points.len() - 1], points };
    let plain = Block::on_grids(SQUARE, x, Grid::graded(0.0, 2.0, z, 6), 6).unwrap();
    let cells = contact_cells(2.0, &boundaries).unwrap();
    let integrals = contact_integrals(&plain.mesh, &cells);
    let found = Block::new(SQUARE, Discretization { grading: 0.25, ..Discretization::uniform(8, 6) })
        .unwrap()
        .compliance(&boundaries)
        .unwrap();
    for (traction, matrix) in [(1, &found.normal), (0, &found.shear)] {
        let mut loads = Mat::zeros(plain.degrees(), cells.len());
        for (j, list) in integrals.iter().enumerate() {
            for &(degree, weight) in list {
                loads[(2 * degree + traction, j)] += weight;
            }
        }
        plain.solve_in_place(&mut loads).unwrap();
        let expected = DMatrix::from_fn(3, 3, |i, j| {
            let sum: f64 = integrals[i].iter().map(|&(degree, weight)| weight * loads[(2 * degree + 1, j)]).sum();
            sum / (cells[i].1 - cells[i].0) / SQUARE.shear_modulus()
        });
        assert!((matrix - &expected).amax() < 1e-5 * expected.amax(), "{}", (matrix - &expected) / expected.amax());
    }
}

#[test]
fn compliance_is_symmetric_definite_and_mirrored() {
    let boundaries = graded_cells(33, 1.0);
    let block = Block::new(SQUARE, Discretization::for_cells(2.0, 2.0, &boundaries, 1e-3)).unwrap();
    let Compliance { normal, shear, asymmetry } = block.compliance(&boundaries).unwrap();
    assert!(asymmetry < 5e-5, "{asymmetry:e}");
    let weighted = DMatrix::from_diagonal(&widths(&boundaries)) * &normal;
    assert!((&weighted - weighted.transpose()).amax() < 1e-15);
    assert!(weighted.symmetric_eigenvalues().min() > 0.0);
    let last = 32;
    let mirrored = |sign: f64, matrix: &DMatrix<f64>| {
        DMatrix::from_fn(33, 33, |i, j| matrix[(i, j)] - sign * matrix[(last - i, last - j)]).amax() / matrix.amax()
    };
    assert!(mirrored(1.0, &normal) < 1e-9);
    assert!(mirrored(-1.0, &shear) < 1e-9);
}

#[test]
fn chosen_order_and_layers_keep_the_tolerance() {
    let boundaries = graded_cells(33, 1.0);
    let widths = widths(&boundaries);
    // Pressure of a flat rigid partner sliding with friction, over its mean; cells may pull, to keep the problem linear.
    let pressure = |compliance: &Compliance| {
        let matrix = &compliance.normal - 0.25 * &compliance.shear;
        let pressure = matrix.lu().solve(&DVector::from_element(33, 1.0)).unwrap();
        2.0 / pressure.dot(&widths) * pressure
    };
    for poissons_ratio in [0.3, 0.4999] {
        let properties = BlockProperties { poissons_ratio, ..SQUARE };
        let solve = |discretization| Block::new(properties, discretization).unwrap().compliance(&boundaries).unwrap();
        let reference = solve(Discretization { grading: 0.3, ..Discretization::uniform(10, 10) });
        let scale = reference.normal.amax();
        let margin = if poissons_ratio > 0.45 { 5.0 } else { 1.0 };
        for tolerance in [1e-2, 1e-3, 1e-4] {
            let found = solve(Discretization::for_cells(2.0, 2.0, &boundaries, tolerance));
            let error = (pressure(&found) - pressure(&reference)).amax();
            assert!(error < margin * tolerance, "{error:e} at tolerance {tolerance:e}, nu = {poissons_ratio}");
            for (found, expected) in [(&found.normal, &reference.normal), (&found.shear, &reference.shear)] {
                let error = (found - expected).amax() / scale;
                assert!(error < 0.2 * margin * tolerance, "{error:e} at {tolerance:e}, nu = {poissons_ratio}");
            }
        }
    }
}

#[test]
fn cells_that_are_mirror_images_answer_like_all_others() {
    let block = Block::new(SQUARE, Discretization::uniform(5, 3)).unwrap();
    for half in [&[0.4, 0.9, 1.0][..], &[0.0, 0.3, 1.0]] {
        let mirrored = half.iter().rev().map(|x| -x).filter(|x| *x < 0.0);
        let symmetric: Vec<f64> = mirrored.chain(half.iter().copied()).collect();
        let mut moved = symmetric.clone();
        moved[2] += 1e-9;
        let [expected, found] = [&moved, &symmetric].map(|boundaries| block.compliance(boundaries).unwrap());
        for (expected, found) in [(&expected.normal, &found.normal), (&expected.shear, &found.shear)] {
            let error = (expected - found).amax() / expected.amax();
            assert!(error < 1e-7, "{error:e}");
        }
    }
}

#[test]
fn refusals_name_variable_value_and_limit() {
    let fine = Discretization::uniform(3, 2);
    let message = |properties, discretization| Block::new(properties, discretization).unwrap_err().to_string();
    assert_eq!(
        message(BlockProperties { poissons_ratio: 0.5, ..SQUARE }, fine),
        "poissons_ratio = 0.5, must be above -1 and below 0.5"
    );
    assert!(message(BlockProperties { width: f64::NAN, ..SQUARE }, fine).starts_with("width = NaN"));
    assert_eq!(
        message(BlockProperties { height: 50.0, ..SQUARE }, fine),
        "height / width = 25, must be from 0.002 to 20"
    );
    assert!(message(SQUARE, Discretization { order: 13, ..fine }).starts_with("order = 13"));
    assert!(message(SQUARE, Discretization { grading: 1.0, ..fine }).starts_with("grading = 1"));
    let block = Block::new(SQUARE, fine).unwrap();
    let message = |boundaries: &[f64]| block.compliance(boundaries).unwrap_err().to_string();
    assert_eq!(message(&[-1.0, 0.5, 0.5, 1.0]), "cell boundary 2 = 0.5 m, must be above its predecessor 0.5 m");
    assert_eq!(message(&[-1.0, 0.9]), "cell boundaries from -1 m to 0.9 m, must span the contact from -1 m to 1 m");
    assert!(matches!(block.compliance(&[]), Err(BlockError::CellsDoNotSpanContact { .. })));
}
