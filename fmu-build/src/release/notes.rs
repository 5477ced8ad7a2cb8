//! Release notes: the section of a version in CHANGELOG.md.

use anyhow::{Result, bail};

const UNRELEASED: &str = "Unreleased";

/// The section of a version, or the one of unreleased changes where the version has none yet; its heading says which.
pub(crate) fn cut(changelog: &str, version: &str) -> Result<String> {
    let title = |line: &str| {
        let word = line.strip_prefix("## ")?.split(' ').next()?;
        Some(word.trim_matches(['[', ']']).to_owned())
    };
    for (wanted, heading) in [(version, version.to_owned()), (UNRELEASED, format!("{version} (unreleased)"))] {
        let mut lines = changelog.lines().skip_while(|line| title(line).as_deref() != Some(wanted));
        if lines.next().is_none() {
            continue;
        }
        let section = lines.take_while(|line| !line.starts_with("## ")).collect::<Vec<_>>().join("\n");
        if section.trim().is_empty() {
            bail!("CHANGELOG.md: the section {wanted} is empty");
        }
        return Ok(format!("# Sliding contact {heading}\n\n{}\n", section.trim()));
    }
    bail!("CHANGELOG.md has no section {version} and none {UNRELEASED}")
}

#[cfg(test)]
mod tests {
    use super::cut;

    #[test]
    fn the_section_of_the_version_is_cut_else_the_unreleased_one() {
        let text =
            "# Changelog\n\n## Unreleased\n\n- new\n\n## [0.2.0] - 2026-01-01\n\n### Added\n- b\n\n## 0.1.0\n- a\n";
        assert_eq!(cut(text, "0.2.0").unwrap(), "# Sliding contact 0.2.0\n\n### Added\n- b\n");
        assert_eq!(cut(text, "0.1.0").unwrap(), "# Sliding contact 0.1.0\n\n- a\n");
        assert_eq!(cut(text, "0.3.0").unwrap(), "# Sliding contact 0.3.0 (unreleased)\n\n- new\n");
        assert!(cut("# Changelog\n", "0.1.0").unwrap_err().to_string().contains("0.1.0"));
        assert!(cut("## 0.1.0\n\n## 0.0.1\n- a\n", "0.1.0").unwrap_err().to_string().contains("empty"));
    }
}
