setTimeout(() => {
  const found = {};
  try {
    hands(found);
  } catch (error) {
    heard.push(error.stack);
  }
  found.errors = heard;
  parent.postMessage(JSON.stringify(found), "*");
}, 700);

function hands(found) {
  const figures = [...document.querySelectorAll(".plot")];
  const panels = (figure) => [...figure.children].filter((e) => e.tagName === "DIV");
  const [one, two] = panels(figures[1]);
  const svg = (panel) => panel.querySelector(":scope > svg");
  const ticks = (panel) => [...svg(panel).querySelectorAll("text")].filter((t) => t.getAttribute("text-anchor") === "middle" && /^[−\d]/.test(t.textContent)).map((t) => t.textContent).join(" ");
  const press = (name) => [...one.querySelectorAll(".tools button")].find((b) => b.textContent === name).click();
  const at = (panel, x, y) => {
    const r = svg(panel).getBoundingClientRect();
    return { clientX: r.left + x * r.width, clientY: r.top + y * r.height, bubbles: true, cancelable: true, pointerId: 1, pointerType: "mouse" };
  };
  const pointer = (panel, kind, x, y, more) => svg(panel).dispatchEvent(new PointerEvent("pointer" + kind, { ...at(panel, x, y), ...more }));
  const read = (panel) => panel.querySelector("output").textContent;
  const key = (key) => svg(one).dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));

  found.width = innerWidth;
  found.dark = matchMedia("(prefers-color-scheme: dark)").matches;
  found.too_wide = Math.max(0, document.documentElement.scrollWidth - innerWidth);

  // the script and the file have the same numbers at their vertical axes if the heights are equal
  found.disagree = [];
  figures.forEach((figure, i) => {
    const still = new DOMParser().parseFromString(figure.querySelector("noscript").textContent, "text/html");
    const numbers = (root) => [...root.querySelectorAll('text[text-anchor="end"]')].map((t) => t.textContent).join(" ");
    const [here, there] = [panels(figure).map(numbers).join(" "), numbers(still)];
    if (i !== 3 && (here !== there || !here)) found.disagree.push(`${here} | ${there}`);
  });

  // texts of a drawing do not overlap and are not cut off
  found.overlaps = [];
  found.cut_off = [];
  figures.flatMap(panels).forEach((panel) => {
    const all = svg(panel).getBoundingClientRect();
    const texts = [...svg(panel).querySelectorAll("text")].map((t) => [t.textContent, t.getBoundingClientRect()]);
    texts.forEach(([words, a], i) => {
      if (a.left < all.left - 1 || a.right > all.right + 1 || a.top < all.top - 1 || a.bottom > all.bottom + 1) found.cut_off.push(words);
      texts.slice(i + 1).forEach(([other, b]) => {
        if (a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 3 && b.top < a.bottom - 3) found.overlaps.push(`${words} | ${other}`);
      });
    });
  });

  // contrast according to WCAG 2: 4.5 for text, 3 for curves of data
  const light = (color) => {
    const [r, g, b] = color.match(/[\d.]+/g).map((v) => (v /= 255) <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const contrast = (a, b) => (Math.max(light(a), light(b)) + 0.05) / (Math.min(light(a), light(b)) + 0.05);
  const ground = (e) => { for (; e; e = e.parentElement) { const c = getComputedStyle(e).backgroundColor; if (!/, 0\)|transparent/.test(c)) return c; } };
  found.faint = [];
  document.querySelectorAll("h1,h2,h3,p,li,td,th,figcaption,summary,button:not([hidden]),.plot text,.plot path.l,.plot path.p").forEach((e) => {
    const style = getComputedStyle(e), path = e.tagName === "path";
    if (path && /s6/.test(e.getAttribute("class"))) return;
    const color = e.tagName === "text" || (path && e.classList.contains("p") && style.fill !== "none") ? style.fill : path ? style.stroke : style.color;
    const ratio = contrast(color, ground(e));
    if (ratio < (path ? 3 : 4.5)) found.faint.push(`${e.tagName} ${e.getAttribute("class")} ${color} on ${ground(e)}: ${ratio.toFixed(2)}`);
  });

  found.first = ticks(one);
  pointer(one, "move", 0.5, 0.5);
  found.pointed = read(one);

  pointer(one, "down", 0.4, 0.5);
  pointer(one, "move", 0.5, 0.5);
  pointer(one, "up", 0.7, 0.5);
  found.dragged = ticks(one);
  found.dragged_below = ticks(two);
  svg(one).dispatchEvent(new MouseEvent("dblclick", { bubbles: true }));
  found.reset = ticks(one);

  svg(one).focus();
  svg(one).dispatchEvent(new WheelEvent("wheel", { ...at(one, 0.5, 0.5), deltaY: -300 }));
  svg(one).dispatchEvent(new WheelEvent("wheel", { ...at(one, 0.5, 0.5), deltaY: -300 }));
  svg(one).dispatchEvent(new WheelEvent("wheel", { ...at(one, 0.5, 0.5), deltaY: -300 }));
  found.wheeled = ticks(one);
  press("reset");
  for (let i = 0; i < 4; i++) press("+");
  found.plus = ticks(one);
  press("reset");

  press("log x");
  found.linear = ticks(one);
  press("log x");
  found.logarithmic = ticks(one);

  const curves = () => svg(one).querySelectorAll("path.l").length;
  const before = curves();
  [...one.querySelectorAll(".legend button")].find((b) => b.textContent === "chain model").click();
  found.hidden = before - curves();

  key("ArrowRight");
  found.key_one = read(one);
  key("ArrowRight");
  key("ArrowRight");
  found.key_two = read(one);

  const touch = (id) => ({ pointerId: id, pointerType: "touch" });
  pointer(one, "down", 0.45, 0.5, touch(2));
  pointer(one, "down", 0.55, 0.5, touch(3));
  pointer(one, "move", 0.44, 0.5, touch(2));
  pointer(one, "move", 0.3, 0.5, touch(2));
  pointer(one, "move", 0.9, 0.5, touch(3));
  pointer(one, "up", 0.3, 0.5, touch(2));
  pointer(one, "up", 0.9, 0.5, touch(3));
  found.pinched = ticks(one);
  press("reset");

  // printing changes the width of the drawing, and the screen is restored afterwards
  const wide = () => svg(one).viewBox.baseVal.width;
  const screen = wide();
  dispatchEvent(new Event("beforeprint"));
  found.paper = wide();
  dispatchEvent(new Event("afterprint"));
  if (wide() !== screen) heard.push(`${screen} pixels before printing, ${wide()} afterwards`);

  // extreme zooms of figures that are hard to draw
  [...panels(figures[2]).slice(0, 1), ...panels(figures[4])].forEach((panel) => {
    [0.2, 0.5, 0.8].forEach((x) => pointer(panel, "move", x, 0.5));
    const buttons = [...panel.querySelectorAll(".tools button")];
    for (let i = 0; i < 110; i++) buttons[0].click();
    for (let i = 0; i < 130; i++) buttons[1].click();
    buttons.slice(2).forEach((b) => b.click());
    for (let i = 0; i < 130; i++) buttons[1].click();
    buttons.slice(2).forEach((b) => b.click());
    if (/NaN|Infinity|undefined/.test(panel.innerHTML)) heard.push("no number in " + panel.querySelector("svg[aria-label]").getAttribute("aria-label"));
  });

  const [round] = panels(figures[3]);
  pointer(round, "move", 0.5, 0.3);
  found.nyquist = read(round);
}
