/** The player in JupyterLab (anywidget): time, playing and picked are kept in step with Python. */

import { startPlayer } from "./player.js";

async function render({ model, el }) {
  const box = document.createElement("div");
  box.style.height = `${model.get("height")}px`;
  el.append(box);
  const player = await startPlayer(box, model.get("shown"), { time: model.get("time") });
  if (!player) return () => {};
  player.pick(model.get("picked"));
  player.on((name, value) => {
    // Every picture of a film would be a message to the kernel.
    if ((name === "time" && player.state.playing) || model.get(name) === value) return;
    model.set(name, value);
    if (name === "playing") model.set("time", player.state.time);
    model.save_changes();
  });
  model.on("change:time", () => player.state.time !== model.get("time") && player.show(model.get("time")));
  model.on("change:picked", () => player.state.picked !== model.get("picked") && player.pick(model.get("picked")));
  model.on("change:playing", () => (model.get("playing") ? player.play() : player.pause()));
  return () => player.destroy();
}

export default { render };
