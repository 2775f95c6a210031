// Findings about a page as it is laid out, sent to the page that frames it.
"use strict";
{
  const found = [];
  addEventListener("error", (event) => found.push(`script: ${event.message}`));
  addEventListener("securitypolicyviolation", (event) => found.push(`policy: ${event.violatedDirective} ${event.blockedURI}`));
  const linear = (v) => ((v /= 255) <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  const luminance = (color) => {
    const [r, g, b] = color.match(/[\d.]+/g).map(Number).map(linear);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const behind = (element) => {
    for (let at = element; at; at = at.parentElement) {
      const color = getComputedStyle(at).backgroundColor;
      if (color !== "transparent" && !/, 0\)$/.test(color)) return color;
    }
    return "rgb(255, 255, 255)";
  };
  const is_shown = (element) => element.getClientRects().length > 0;
  const start = (element) => element.textContent.trim().replace(/\s+/g, " ").slice(0, 60);

  const look = () => {
    const page = document.documentElement;
    if (page.scrollWidth > innerWidth) found.push(`the page is ${page.scrollWidth} wide`);
    for (const row of document.querySelectorAll("tbody tr")) {
      if (!is_shown(row) || getComputedStyle(row).display !== "table-row") continue;
      const lines = row.getBoundingClientRect().height / parseFloat(getComputedStyle(row.cells[0]).lineHeight);
      // three lines and the space around them
      if (lines > 3.6) found.push(`a row of ${lines.toFixed(1)} lines: ${start(row)}`);
    }
    // what is unfolded may scroll, and narrow screens do
    if (innerWidth > 1000)
      for (const box of document.querySelectorAll(".scroll"))
        if (is_shown(box) && !box.closest("details") && box.scrollWidth > box.clientWidth + 1) found.push(`a table is cut: ${start(box)}`);
    for (const element of document.body.querySelectorAll("*")) {
      const has_text = [...element.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.textContent.trim());
      if (!has_text || !is_shown(element) || /^(script|style)$/i.test(element.tagName)) continue;
      const is_drawn = element instanceof SVGElement, style = getComputedStyle(element);
      const one = luminance(is_drawn ? style.fill : style.color), other = luminance(behind(is_drawn ? element.closest("div") : element));
      const contrast = (Math.max(one, other) + 0.05) / (Math.min(one, other) + 0.05);
      if (contrast < 4.5) found.push(`a contrast of ${contrast.toFixed(2)}: ${start(element)}`);
    }
    for (const element of document.querySelectorAll("button, summary, a[href], [tabindex]")) {
      const label = element.getAttribute("aria-label") || document.getElementById(element.getAttribute("aria-labelledby"))?.textContent || element.textContent;
      if (is_shown(element) && !label.trim()) found.push(`no name: ${element.outerHTML.slice(0, 60)}`);
    }
    for (const plot of document.querySelectorAll(".plot")) if (!plot.querySelector("svg path")) found.push("a figure is empty");
    parent.postMessage({ view: VIEW, found: [...new Set(found)] }, "*");
  };
  addEventListener("load", () => setTimeout(look, 0));
}
