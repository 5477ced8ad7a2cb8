//! Tables as users and rigs write them.

use super::*;
use scene::variables::units::{KELVIN, METRE_PER_SECOND, NEWTON};

fn accepted() -> Vec<Column> {
    let speed = Column { required: true, unit_required: true, ..Column::optional("speed", &METRE_PER_SECOND) };
    let offset = Column { absolute: false, ..Column::optional("offset", &KELVIN) };
    vec![speed, Column::optional("normal_load", &NEWTON), Column::optional("outside", &KELVIN), offset]
}

fn table(name: &str, text: &str) -> Result<Table> {
    let path = std::env::temp_dir().join(format!("columns-{}-{name}.csv", std::process::id()));
    std::fs::write(&path, text).unwrap();
    let result = read(&path, &accepted(), &Reading::default());
    std::fs::remove_file(&path).unwrap();
    result
}

#[test]
fn the_record_of_a_run_is_read_as_inputs_with_or_without_the_index_of_pandas() {
    let parsed = |text: &str| parse(text.as_bytes(), Path::new("run.csv"), &Column::inputs(), &Reading::default());
    let run = "time [s],sliding_velocity [m/s],wear_depth [m],normal_load [N]\n0,1,2,3\n1,4,5,6\n";
    let indexed = ",time [s],sliding_velocity [m/s],wear_depth [m],normal_load [N]\n0,0,1,2,3\n7,1,4,5,6\n";
    for text in [run, indexed] {
        let table = parsed(text).unwrap();
        assert_eq!(table.names, ["sliding_velocity", "normal_load"], "{text}");
        assert_eq!(table.left_out, ["wear_depth"], "{text}");
        assert_eq!((table.times, table.values), (vec![0.0, 1.0], vec![1.0, 3.0, 4.0, 6.0]), "{text}");
    }
    for (text, told) in [
        (
            indexed.replace("\n7,", "\n7.5,"),
            "line 3, column 1 (): \"7.5\" is no number of a row, and its column has no name",
        ),
        (run.replace("wear_depth [m]", ""), "line 1, column 3: \"\" is not a known quantity"),
        (run.replace("wear_depth [m]", "wear_depth [s]"), "\"s\" is the wrong unit"),
        (run.replace("wear_depth", "wear_dept"), "did you mean wear_depth?"),
    ] {
        let message = parsed(&text).unwrap_err().to_string();
        assert!(message.contains(told), "{message}");
    }
}

#[test]
fn gaps_of_an_input_are_bridged_where_nothing_is_invented() {
    let slow =
        table("slow", "time,speed_m_per_s,normal_load\n0,1,\n1,2,10\n2,,\n3,4,nan\n4,5,16\n5,6,n/a\n6,7,20\n").unwrap();
    assert_eq!(slow.column("speed").unwrap().collect::<Vec<_>>(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    assert_eq!(slow.column("normal_load").unwrap().collect::<Vec<_>>(), [10.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0]);
    let rows = |load: [&str; 9]| {
        let row = |(time, load): (usize, &&str)| format!("{time},1,{load}\n");
        format!("time,speed_m_per_s,normal_load\n{}", load.iter().enumerate().map(row).collect::<String>())
    };
    // The same on both sides of a long gap.
    let held = table("held", &rows(["9", "8", "8", "", "", "", "", "8.1", "5"])).unwrap();
    assert!((held.column("normal_load").unwrap().nth(4).unwrap() - 8.04).abs() < 1e-12);
    for (load, told) in [
        (["9", "8", "8", "", "", "", "", "3", "5"], "lines 4 to 9: normal_load has no value for 5 s from 8 N to 3 N"),
        (["", "", "", "", "8", "", "8", "3", "5"], "lines 2 to 6: normal_load has no value for 4 s at the beginning"),
        (["9", "8", "8", "7", "", "", "", "", ""], "lines 5 to 10: normal_load has no value for 5 s at the end"),
        ([""; 9], "the column normal_load has no value"),
    ] {
        let message = table("gap", &rows(load)).unwrap_err().to_string();
        assert!(message.contains(told), "{message}\nis without {told}");
    }
}

#[test]
fn a_record_keeps_its_gaps_and_a_time_in_two_rows() {
    let text = "time [s],contact_temperature [degC],wear_depth [um]\n0,20,#DIV/0!\n1,,#NV\n1,25,NaN\n2,30,4\n";
    let read = parse(text.as_bytes(), Path::new("a.csv"), &Column::record(), &Reading::default()).unwrap();
    let wear: Vec<f64> = read.column("wear_depth").unwrap().collect();
    assert_eq!(read.times, [0.0, 1.0, 1.0, 2.0]);
    assert!(wear[..3].iter().all(|wear| wear.is_nan()) && wear[3] == 4e-6, "{wear:?}");
    assert!(read.column("contact_temperature").unwrap().nth(1).unwrap().is_nan());
    assert_eq!(read.points("contact_temperature").unwrap(), [(0.0, 293.15), (2.0, 303.15)]);
    assert_eq!(read.points("wear_depth").unwrap(), [(2.0, 4e-6)]);
}

#[test]
fn columns_are_renamed_left_out_or_refused() {
    let text = "time [s],Kraft [kN],Humidity [%],COF 2\n0,1,40,0.4\n1,2,41,0.5\n";
    let read = |columns: &[&str], strict: bool| {
        let reading = Reading {
            columns: columns.iter().map(|named| named.parse().unwrap()).collect(),
            strict,
            ..Reading::default()
        };
        let table = parse(text.as_bytes(), Path::new("rig.csv"), &Column::record(), &reading)?;
        reading.check(&[&table.headers]).map(|()| table)
    };
    let all = ["Kraft=normal_load", "COF 2=friction_coefficient", "Humidity="];
    let named = read(&all, true).unwrap();
    assert_eq!((named.names.len(), named.values[0], named.values[1]), (2, 1000.0, 0.4));
    assert!(named.notes.is_empty(), "{:?}", named.notes);
    let first = read(&all[..1], false).unwrap();
    assert_eq!(first.names, ["normal_load"]);
    assert_eq!(first.notes.len(), 1);
    assert!(
        first.notes[0].contains("rig.csv: left out are \"Humidity [%]\", \"COF 2\"; --column"),
        "{:?}",
        first.notes
    );
    for (columns, strict, told) in [
        (&[][..], true, "column 2: \"Kraft [kN]\" is not a known quantity"),
        (
            &["Kraft [kN]=normal_load [N]", "Kaft=wear_depth"][..],
            false,
            "there is no column \"Kaft\"; found are time [s], Kraft",
        ),
        (&["Kraft=normal_laod"][..], false, "did you mean normal_load?"),
        (&["Kraft=nothing"][..], false, "\"nothing [kN]\" is not a known quantity"),
        (&["Kraft=tiem"][..], false, "time?"),
        (&["COF 2=normal_load"][..], false, "does not say its unit"),
    ] {
        let message = read(columns, strict).unwrap_err().to_string();
        assert!(message.contains(told), "{message}\nis without {told}");
    }
    assert!("COF".parse::<Named>().unwrap_err().contains("HEADER=VARIABLE"));
}

#[test]
fn columns_are_known_by_name_and_converted() {
    let text =
        "\u{feff}# a note\nnormal_load[kN], time [min], outside [degC], speed_km_per_h\n3, 0, 20, 36\n4, 1, 30, 72\n";
    let read = table("units", text).unwrap();
    assert_eq!(read.times, [0.0, 60.0]);
    assert_eq!(read.names, ["normal_load", "outside", "speed"]);
    assert_eq!(read.column("speed").unwrap().collect::<Vec<_>>(), [10.0, 20.0]);
    assert_eq!(read.column("normal_load").unwrap().collect::<Vec<_>>(), [3000.0, 4000.0]);
    assert_eq!(read.column("outside").unwrap().collect::<Vec<_>>(), [293.15, 303.15]);
    assert!(read.column("offset").is_none());
    let plain = table("plain", "time_s,speed_m_per_s,normal_load\n0,0.1,7\n").unwrap();
    assert_eq!((plain.values, plain.lines), (vec![0.1, 7.0], vec![2]));
}

#[test]
fn thousands_may_have_another_mark() {
    for text in [
        "time;speed_m_per_s;normal_load\n0;1,5;-1 234 567,25\n1;0;12\u{202f}000\n",
        "time,speed_m_per_s,normal_load\n0,1.5,-1'234'567.25\n1,0,12\u{a0}000\n",
        "time;speed_m_per_s;normal_load\n0;1,5;-1.234.567,25\n1;0;12.000,0\n",
        "time,speed_m_per_s,normal_load\n0,1.5,\"-1,234,567.25\"\n1,0,\"12,000.0\"\n",
    ] {
        assert_eq!(table("groups", text).unwrap().values, [1.5, -1_234_567.25, 0.0, 12_000.0]);
    }
}

#[test]
fn times_of_day_count_from_the_first_row() {
    for (text, times) in [
        ("time,speed_m_per_s\n09:00:00,1\n09:00:00.5,1\n10:01,1\n", [0.0, 0.5, 3660.0]),
        ("time;speed_m_per_s\n23:59:59;1\n00:00:00,5;1\n00:00:02;1\n", [0.0, 1.5, 3.0]),
        (
            "time,speed_m_per_s\n2026-02-28T23:00:00Z,1\n2026-03-01 00:00:00,1\n01.03.2026 00:00:01,1\n",
            [0.0, 3600.0, 3601.0],
        ),
        ("time,speed_m_per_s\n11:59:59.5 AM,1\n12:00:00 PM,1\n1:00 pm,1\n", [0.0, 0.5, 3600.5]),
        (
            "time,speed_m_per_s\n11/30/2026 11:59:59 PM,1\n12/1/2026 12:00:00 AM,1\n12/1/2026 12:01 AM,1\n",
            [0.0, 1.0, 61.0],
        ),
        (
            "time,speed_m_per_s\n2026-02-28 23:00:00 +00:00,1\n2026-03-01T01:00:00.5+02:00,1\n2026/02/28 23:01,1\n",
            [0.0, 0.5, 60.0],
        ),
    ] {
        assert_eq!(table("hours", text).unwrap().times, times);
    }
}

#[test]
fn what_does_not_fit_is_refused_with_its_place_and_what_would() {
    for (name, text, wanted) in [
        (
            "order",
            "speed_m_per_s,normal_load\n0,1\n",
            "line 1: no column time or time [s or min or h or ms]; found are",
        ),
        (
            "missing",
            "Dauer [s],sliding_velocity [m/s]\n0,1\n",
            "Dauer [s], sliding_velocity [m/s]; --column \"Dauer [s]=time\" names one that has its unit",
        ),
        ("missing", "time,normal_load\n0,1\n", "no column speed [m/s or km/h or mm/s or m/min or cm/s]"),
        ("unknown", "time,slope\n0,1\n", "no column speed [m/s or km/h"),
        ("bare", "time,speed\n0,1\n", "column 2: \"speed\" does not say its unit; accepted is speed [m/s"),
        ("unit", "time,speed [mph]\n0,1\n", "\"mph\" is the wrong unit; accepted are m/s, km/h, mm/s"),
        ("difference", "time,speed [m/s],offset [degC]\n0,1,2\n", "accepted are K"),
        ("twice", "time,speed_m_per_s,speed [km/h]\n0,1,2\n", "column 3: speed stands in column 2 already"),
        ("word", "time,speed_m_per_s\n0,1\n1,fast\n", "line 3, column 2 (speed_m_per_s): \"fast\" is no number"),
        ("empty", "time,speed_m_per_s,normal_load\n,1,1\n", "line 2, column 1 (time): \"\" is no number"),
        ("infinite", "time,speed_m_per_s\n0,inf\n", "\"inf\": inf is not a finite number"),
        (
            "beyond",
            "time,speed_m_per_s,normal_load [kN]\n0,1,1e306\n",
            "\"1e306\": 1e306 kN is no finite number in the SI unit",
        ),
        ("back", "time,speed_m_per_s\n0,1\n1,1\n.5,1\n", "line 4, column 1 (time): \".5\": the time must not decrease"),
        (
            "thrice",
            "time,speed_m_per_s\n1,1\n1,1\n1,1\n",
            "line 4, column 1 (time): \"1\": a time may stand in two rows",
        ),
        ("none", "time,speed_m_per_s\n", "has no row"),
        ("binary", "time\0speed\n", "is no text; a CSV or Parquet file is needed"),
        ("parquet", "PAR1 and no more", "reading"),
        ("nothing", "", "is empty; its first line must name the columns"),
        ("notes", "# nothing\n", "is empty"),
        (
            "marks",
            "time;speed_m_per_s\n0.5;1\n1;1,5\n",
            "line 3, column 2 (speed_m_per_s): \"1,5\" has another decimal mark",
        ),
        ("blanks", "time;speed_m_per_s\n0;1 23,5\n", "\"1 23,5\" is no number"),
        ("thousands", "time;speed_m_per_s\n0;1.23,5\n", "\"1.23,5\" has a point and a comma"),
        (
            "integers",
            "time;speed_m_per_s\n0;1,5\n1;1.234\n",
            "line 3, column 2 (speed_m_per_s): \"1.234\" has another decimal mark",
        ),
        ("decimal", "time,speed_m_per_s\n0,\"0,5\"\n", "\"0,5\" has a comma; numbers have a decimal point"),
        ("slip", "time,speeed [m/s]\n0,1\n", "; did you mean speed?"),
        ("clock", "time,speed_m_per_s\n12:00:61,1\n", "12:00:61\" is no time of day, as 09:00:00.5"),
        ("clock", "time,speed_m_per_s\n12:00:01,1\n12:00:00,1\n", "the time must not decrease"),
        (
            "code",
            "time,speed_m_per_s,outside [degC]\n0,1,-999\n",
            "\"-999\" is below absolute zero; a gap is an empty cell",
        ),
        ("preamble", "Rig;3\nDauer;v [m/s];Kraft\n0;1;2\n", "line 2: no column time or time [s"),
        ("ragged", "time,speed_m_per_s\n0,1\n1\n", "line 3: 1 cells, and the header has 2"),
        ("comma", "time,speed_m_per_s\n0,5,1\n", "line 2: 3 cells, and the header has 2; numbers have a decimal point"),
    ] {
        let told = format!("{:#}", table(name, text).unwrap_err());
        assert!(told.contains(wanted), "{told}\nis without {wanted}");
    }
}
