// The whole log, drawn of the numbers in its link, to zoom into.
(() => {
  const at = (id) => document.getElementById(id);
  const links = [...document.querySelectorAll("a[data-log]")];
  const soft = "#565c62", estimate = "#0060a8";
  let columns = [[]], whole = [0, 1], view = whole, plots = [];

  const number = (text) => (text === "" ? null : Number(text));
  const read = ({ href }) => {
    const rows = decodeURIComponent(href.slice(href.indexOf(",") + 1)).trim().split("\n").slice(1).map((row) => row.split(",").map(number));
    const [seconds, voltage, sensor, estimated] = [0, 1, 2, 3].map((column) => rows.map((row) => row[column]));
    const error = estimated.map((value, row) => (value === null || sensor[row] === null ? null : value - sensor[row]));
    return [seconds, voltage, sensor, estimated, error];
  };

  const said = (value, digits) => (value === null || value === undefined ? "–" : value.toFixed(digits).replace("-", "−"));
  const say = (row) => {
    const [seconds, voltage, sensor, estimated, error] = columns.map((column) => column[row]);
    at("zoom-said").textContent = row === null || row === undefined
      ? `${said(view[0], 3)} … ${said(view[1], 3)} s of ${said(whole[0], 3)} … ${said(whole[1], 3)} s`
      : `${said(seconds, 4)} s: ${said(voltage, 3)} V, sensor ${said(sensor, 4)} µm, estimate ${said(estimated, 4)} µm, off by ${said(error, 4)} µm`;
  };

  // No wider than the log, and no closer than its rows tell anything.
  const show = (from, to) => {
    const [first, last] = whole, least = Math.min(last - first, 4 * (last - first) / Math.max(columns[0].length - 1, 1));
    const width = Math.min(Math.max(to - from, least), last - first);
    const start = Math.max(Math.min((from + to - width) / 2, last - width), first);
    view = [start, Math.min(start + width, last)];
    for (const plot of plots) plot.setScale("x", { min: view[0], max: view[1] });
    say(null);
    // What is shown, for tests of the page.
    window.zoom = { log: at("zoom-log").value, view, whole, rows: columns[0].length };
  };
  const around = (factor, shift) => {
    const [from, to] = view, width = to - from, middle = (from + to) / 2 + shift * width;
    show(middle - factor * width / 2, middle + factor * width / 2);
  };
  const all = () => show(...whole);

  const axis = (size) => ({ stroke: soft, font: "12px system-ui, sans-serif", size, grid: { stroke: "#e7e9eb", width: 1 }, ticks: { stroke: "#e7e9eb", width: 1 } });
  const selected = (plot) => {
    const { left, width } = plot.select;
    if (!width) return;
    const [from, to] = [left, left + width].map((x) => plot.posToVal(x, "x"));
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    show(from, to);
  };
  const draw = (id, height, curves) => {
    const place = at(id);
    const plot = new uPlot({
      width: place.clientWidth, height, padding: [8, 12, 0, 0], legend: { show: false },
      cursor: { y: false, points: { show: false }, drag: { x: true, y: false, setScale: false }, bind: { dblclick: () => all } },
      scales: { x: { time: false } }, axes: [axis(32), axis(64)],
      series: [{}, ...curves.map(([, stroke, width]) => ({ stroke, width, points: { show: false } }))],
      hooks: { setSelect: [selected], setCursor: [({ cursor }) => say(cursor.idx)] },
    }, [columns[0], ...curves.map(([column]) => columns[column])], place);
    // A canvas is no text: what it shows stands above it.
    place.querySelector("canvas").setAttribute("aria-hidden", "true");
    return plot;
  };
  const choose = () => {
    const link = links[at("zoom-log").selectedIndex], { rows, of } = link.dataset;
    for (const plot of plots) plot.destroy();
    columns = read(link);
    whole = [columns[0][0], columns[0][columns[0].length - 1]];
    plots = [draw("zoom-displacement", 260, [[2, "#70757a", 3], [3, estimate, 1.5]]), draw("zoom-error", 170, [[4, "#c8500a", 1.2]]), draw("zoom-voltage", 150, [[1, "#16191c", 1.2]])];
    at("zoom-rows").textContent = rows === of ? `All ${of} rows are drawn.`
      : `Drawn of ${rows} of the log's ${of} rows: in each stretch of time the first, and those at which voltage, sensor and error are least and largest.`;
    all();
  };

  for (const { dataset } of links) at("zoom-log").add(new Option(dataset.log));
  at("zoom").hidden = false;
  at("zoom-log").addEventListener("change", choose);
  for (const [id, act] of [["closer", () => around(0.5, 0)], ["wider", () => around(2, 0)], ["before", () => around(1, -0.5)], ["after", () => around(1, 0.5)], ["whole", all]]) {
    at(`zoom-${id}`).addEventListener("click", act);
  }
  new ResizeObserver(() => {
    for (const plot of plots) plot.setSize({ width: plot.root.parentElement.clientWidth, height: plot.height });
  }).observe(at("zoom"));
  choose();
})();
