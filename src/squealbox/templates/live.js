// What moves in place of its printed picture: figures that are read out and zoomed into, brakes that vibrate.
const period = 2400; // ms
const HOW = "Drag it or use the arrow keys to turn it; click it and use the wheel to come nearer; Z looks along the axis.";
const calm = matchMedia("(prefers-reduced-motion: reduce)");

/** What a figure is drawn from, its arrays unpacked. */
function given(figure) {
  const { arrays: packed, ...rest } = JSON.parse(figure.querySelector("script").textContent);
  const unpacked = ([kind, text]) => new globalThis[kind](Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
  figure.classList.add("moves");
  return { ...rest, arrays: Object.fromEntries(Object.entries(packed).map(([name, each]) => [name, unpacked(each)])) };
}

/** The figures of one chart, which are zoomed together along an axis they share. */
function drawCharts(place) {
  const { figures, arrays } = given(place);
  const charts = figures.map(({ name }) => new Chart(place.querySelector(".live"), { name, height: figures.length > 1 ? 300 : 420 }));
  const draw = () => charts.forEach((chart, i) => chart.draw(resolved(figures[i], arrays)));
  const along = (axis, x) => charts.filter(({ spec }) => spec.x.label === axis.label).forEach((chart) => {
    chart.zoom = { ...chart.zoom, x, of: axis.label + chart.spec.y.label };
    chart.draw(chart.spec);
  });
  draw();
  for (const chart of charts) zoomable(chart, (axis, ends) => axis === chart.spec.x && along(axis, ends));
  night.addEventListener("change", draw);
}

/** The outline of the brake at rest, over its picture. */
function rest({ canvas, view, size }, { places, outline }) {
  const pen = canvas.getContext("2d");
  const scale = (0.47 * view.near * Math.min(canvas.width, canvas.height)) / size;
  const [ct, st, ce, se] = [Math.cos(view.turn), Math.sin(view.turn), Math.cos(view.tilt), Math.sin(view.tilt)];
  const at = (i) => [canvas.width / 2 + scale * (ct * places[i] - st * places[i + 1]), canvas.height / 2 - scale * (ce * (st * places[i] + ct * places[i + 1]) + se * places[i + 2])];
  pen.strokeStyle = shade() === "dark" ? "rgb(255 255 255 / 45%)" : "rgb(0 0 0 / 45%)";
  pen.lineWidth = 0.8 * (window.devicePixelRatio || 1);
  pen.beginPath();
  for (let k = 0; k < outline.length; k += 2) {
    pen.moveTo(...at(3 * outline[k]));
    pen.lineTo(...at(3 * outline[k + 1]));
  }
  pen.stroke();
}

/** What draws a brake in 3-D at a phase [rad] of its mode; `again` is called when it was turned. */
function solid(place, { data, arrays, normal }, again) {
  const mesh = new Mesh(place, { arrays, data }, again);
  Object.assign(mesh, { re: arrays.re, im: arrays.im, shares: arrays.shares, normal });
  mesh.view.near = 1.3;
  place.addEventListener("wheel", (event) => document.activeElement === mesh.canvas || event.stopPropagation(), { capture: true }); // the page scrolls by
  return { draw: (phase) => (mesh.draw(phase), rest(mesh, arrays)), keys: () => [...mesh.keys(), make("small", {}, HOW)] };
}

/** The same of the drawing of a brake. */
function flat(place, { data, arrays: { points, re, im } }) {
  const { svg, parts } = drawn(data, points, "The brake vibrating in its worst mode");
  place.classList.add("drawing");
  place.append(svg);
  const at = (i, phase) => points[i] + re[i] * Math.cos(phase) - im[i] * Math.sin(phase);
  return { draw: (phase) => parts((p) => [at(2 * p, phase), at(2 * p + 1, phase)]), keys: () => [] };
}

for (const figure of document.querySelectorAll("figure.vibrating")) {
  const about = given(figure);
  let [phase, held, seen] = [0, calm.matches, false];
  const { draw, keys } = (about.data.shapes ? flat : solid)(figure.querySelector(".live"), about, () => draw(phase));
  const play = button("", () => say(!held));
  const say = (now) => (play.textContent = (held = now) ? "Move" : "Pause");
  say(held);
  const told = () => figure.querySelector(".keys").replaceChildren(play, " ", ...keys());
  told();
  night.addEventListener("change", () => (draw(phase), told()));
  new IntersectionObserver(([now]) => (seen = now.isIntersecting)).observe(figure);
  const step = (now) => {
    requestAnimationFrame(step);
    if (!seen || held) return;
    draw((phase = (2 * Math.PI * now) / period));
  };
  requestAnimationFrame(step);
}

try {
  if (!CSS.supports("color", "light-dark(#000, #fff)")) throw new Error("this browser is older than they are");
  document.querySelectorAll("figure.plotted").forEach(drawCharts);
  document.documentElement.dataset.charts = "drawn";
} catch (error) {
  document.querySelectorAll("figure.plotted").forEach((figure) => figure.classList.remove("moves"));
  document.documentElement.dataset.charts = "still";
  document.getElementById("still").textContent = `The figures stand still here: ${error}.`;
}
