// What layout.rs judges, as JSON. Lengths in CSS px as they appear on the screen.
(async () => {
  await document.fonts.ready;
  const box = (element) => {
    const { left, right, top, bottom } = element.getBoundingClientRect();
    return { left, right, top, bottom };
  };
  const drawn = (mark) => {
    const style = getComputedStyle(mark);
    return mark.getTotalLength() > 0 && (style.stroke !== "none" || style.fill !== "none")
      && mark.getClientRects().length > 0;
  };
  // A canvas has pixels for marks: those that neither grid nor letter explains, which are grey and pale.
  const coloured = (canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let at = 0; at < data.length; at += 4) {
      const [least, most] = [Math.min(data[at], data[at + 1], data[at + 2]), Math.max(data[at], data[at + 1], data[at + 2])];
      if (data[at + 3] > 200 && (most - least > 60 || most < 60)) count += 1;
    }
    return count;
  };
  const plots = [...document.querySelectorAll("figure svg, figure canvas")].filter((plot) => plot.checkVisibility()).map((plot) => ({
    box: box(plot),
    marks: plot instanceof HTMLCanvasElement ? coloured(plot) : [...plot.querySelectorAll("path, polyline")].filter(drawn).length,
  }));

  // An SVG's text shrinks with its drawing, whatever its font-size says.
  const magnification = (element) => {
    if (!(element instanceof SVGGraphicsElement)) return 1;
    const { a, b, c, d } = element.getScreenCTM();
    return Math.sqrt(Math.abs(a * d - b * c));
  };
  const texts = new Map();
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement;
    if (!walker.currentNode.data.trim() || !element.getClientRects().length || !element.checkVisibility()) continue;
    const svg = element.ownerSVGElement;
    texts.set(element, {
      text: walker.currentNode.data.trim().slice(0, 40),
      size: parseFloat(getComputedStyle(element).fontSize) * magnification(element),
      box: box(element),
      plot: svg && box(svg),
    });
  }
  return JSON.stringify({
    title: document.title,
    // Not innerWidth, which on a telephone grows with what is too wide.
    width: document.documentElement.clientWidth,
    scroll_width: document.scrollingElement.scrollWidth,
    plots,
    texts: [...texts.values()],
  });
})()
