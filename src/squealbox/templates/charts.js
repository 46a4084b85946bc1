
"use strict";
// Unpacks plotly.js, which lies in this page, and draws every chart over its printed picture.
(async () => {
  const figures = [...document.querySelectorAll("figure.chart")];
  try {
    const packed = document.getElementById("library").textContent.trim();
    const bytes = Uint8Array.from(atob(packed), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    const script = document.createElement("script");
    script.textContent = await new Response(stream).text();
    document.head.append(script);
    for (const figure of figures) {
      const place = figure.querySelector(".live");
      const { data, layout } = JSON.parse(figure.querySelector("script").textContent);
      figure.classList.add("moves");
      await Plotly.newPlot(place, data, layout, { responsive: true, displaylogo: false });
    }
    document.documentElement.dataset.charts = "drawn";
  } catch (error) {
    figures.forEach((figure) => figure.classList.remove("moves"));
    document.documentElement.dataset.charts = "still";
    document.getElementById("still").textContent = `The figures stand still here: ${error}.`;
  }
})();
