// The friction curve: the range of speeds that the last motion passed lies behind it, while that is of this design.

export default {
  setup: (panel) => panel.app.addEventListener("motion", () => panel.frame && panel.draw(panel.frame)),

  more(panel, spec) {
    const { motion } = panel.app;
    if (!motion?.speeds?.length) return spec;
    const ends = motion.speeds.map(([low, high]) => [low <= 0 && high >= 0 ? 0 : Math.min(Math.abs(low), Math.abs(high)), Math.max(Math.abs(low), Math.abs(high))]);
    const [from, to] = [Math.min(...ends.map(([low]) => low)), Math.min(spec.x.domain[1], Math.max(...ends.map(([, high]) => high)))];
    const words = { kind: "text", cls: "label", x: (from + to) / 2, y: spec.y.domain[0], words: "range of the motion" };
    return { ...spec, layers: [{ kind: "band", from, to, cls: "operating", name: "passed" }, ...spec.layers, words] };
  },
};
