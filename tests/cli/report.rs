//! `foldline report`: what stands in the page, and what it refuses. `report.py` looks at it in a browser.

use crate::program::Sandbox;

/// The data in a page.
fn data(page: &str) -> serde_json::Value {
    let (_, rest) = page.split_once("id=\"data\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn the_page_holds_the_runs_whole() {
    let place = Sandbox::new();
    place.foldline("run small.toml -o one.mcap --until 4").ends(0);
    place.foldline("run small.toml -o two.mcap").ends(0);
    place.foldline("report one.mcap two.mcap -o page.html").ends(0);
    let page = String::from_utf8(std::fs::read(place.file("page.html")).unwrap()).unwrap();
    assert!(!page.contains("src=\"") && !page.contains("href=\"http"), "it needs a network");
    let runs = data(&page);
    assert_eq!((runs[0]["name"].as_str(), runs[1]["name"].as_str()), (Some("one"), Some("two")));
    let log = place.log("two.mcap");
    let last = &log.entries().last().unwrap().record;
    let point = runs[1]["points"].as_array().unwrap().last().unwrap();
    assert_eq!(point["at"].as_f64(), Some(16.0));
    assert_eq!(point["value"].as_f64(), Some(last.report.moment_n_mm));
    assert!(page.contains(&last.commit.chain_hash.to_string()));
    assert_eq!(runs[1]["snaps"].as_array().unwrap().len(), 1);
    let shape = &runs[1]["shape"];
    let frames = shape["frames"].as_array().unwrap();
    assert_eq!(frames.len(), runs[1]["points"].as_array().unwrap().len());
    let [n1, n2] = [0, 1].map(|direction| shape["counts"][0][direction].as_u64().unwrap());
    // Three coordinates of two bytes each, in base64.
    let coded = frames[0]["points"].as_str().unwrap().len() as u64;
    assert_eq!(coded, (6 * n1 * n2).div_ceil(3) * 4);
}

/// What a scene says cannot end the data.
#[test]
fn a_scene_cannot_write_into_the_page() {
    let place = Sandbox::new();
    let text = String::from_utf8(std::fs::read(place.file("small.toml")).unwrap()).unwrap();
    place.write("sly.toml", format!("# </script><script>alert(1)</script> {{{{title}}}}\n{text}"));
    place.foldline("run sly.toml -o sly.mcap --until 2").ends(0);
    place.foldline("report sly.mcap").ends(0);
    let page = String::from_utf8(std::fs::read(place.file("sly.html")).unwrap()).unwrap();
    assert!(!page.contains("<script>alert"));
    assert!(data(&page)[0]["scene"].as_str().unwrap().starts_with("# </script><script>alert(1)</script> {{title}}"));
}

#[test]
fn what_is_in_the_way_stays_and_an_empty_log_is_refused() {
    let place = Sandbox::new();
    place.foldline("run small.toml -o log.mcap --until 2").ends(0);
    place.write("log.html", "mine");
    let said = place.foldline("report log.mcap").ends(2);
    assert!(said.err.contains("log.html"), "{}", said.err);
    assert_eq!(std::fs::read(place.file("log.html")).unwrap(), b"mine");
    let said = place.foldline("report nothing.mcap").ends(2);
    assert!(said.err.contains("nothing.mcap"), "{}", said.err);
}
