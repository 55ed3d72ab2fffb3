//! The page: one file with its style, its plotting library ([`uplot`]) and its script.

use std::sync::LazyLock;

/// The page. It holds nothing of a device, and asks for that at the address it was had from.
pub static PAGE: LazyLock<String> = LazyLock::new(|| {
    [
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"generator\" content=\"piezo\">\n",
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n",
        "<title>piezo monitor</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>\n",
        uplot::STYLE,
        "\n",
        include_str!("../page/scope.css"),
        "</style>\n</head>\n<body>\n",
        include_str!("../page/scope.html"),
        uplot::SCRIPT,
        "<script>\n",
        include_str!("../page/history.js"),
        include_str!("../page/scope.js"),
        "</script>\n</body>\n</html>\n",
    ]
    .concat()
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_one_file_with_the_licence_of_what_it_has_of_others() {
        assert!(PAGE.contains("uPlot (v1.6.32)") && PAGE.contains("Permission is hereby granted"));
        for loads in ["src=", "@import", "url(", "import(", "<link rel=\"stylesheet\""] {
            assert!(!PAGE.contains(loads), "{loads}");
        }
        // Either would end a script within it.
        assert_eq!(PAGE.matches("</script>").count(), 2);
        assert_eq!(PAGE.matches("-->").count(), 1);
    }
}
