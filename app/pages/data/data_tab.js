// The data tab: the visitor's own curve, questions about its file, and the misfit of the model.

import { button, download, element, paragraph, table } from "../../parts/toolkit/dom.js";

const FORM =
  "A curve of frequency and largest force, or a series of time, input and output force: CSV or TSV from any " +
  "spreadsheet, WebPlotDigitizer, HDF5 or netCDF-4. " +
  "Choose it, or drop it anywhere on the page. You will be asked about anything the file leaves open.";
const SENSITIVITY = "V, with its sensor's sensitivity";
const CHUNK = 0x8000; // bytes converted to text at once

// Encodes the bytes unchanged; the browser's text() would decode the file as UTF-8.
async function base64Of(file) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  let text = "";
  for (let at = 0; at < bytes.length; at += CHUNK) text += String.fromCharCode(...bytes.subarray(at, at + CHUNK));
  return btoa(text);
}

async function sendFile(model, [chosen]) {
  if (!chosen) return;
  if (chosen.size > model.state.largest_file) model.send_msg({ do: "measurement-too-large", name: chosen.name });
  else model.send_msg({ do: "measurement", name: chosen.name, content: await base64Of(chosen).catch(() => null) });
}

// Reads a file that is dropped anywhere on the page as if it had been chosen in this tab, and calls `accepted`. Without
// this, the browser would leave the page to show the file. The server refuses what cannot be read, such as a folder.
export function acceptDroppedFiles(model, accepted) {
  const hasFile = (event) => event.dataTransfer?.types.includes("Files");
  document.addEventListener("dragover", (event) => {
    if (hasFile(event)) event.preventDefault();
  });
  document.addEventListener("drop", (event) => {
    if (!hasFile(event)) return;
    event.preventDefault();
    if (window.granchain.connection.lost) return;
    accepted();
    sendFile(model, event.dataTransfer.files);
  });
}

// Lets the browser save the sample file that the server sent.
export function saveSample({ type, name, text }) {
  if (type !== "sample") return;
  download(name, new Blob([text], { type: "text/csv" }));
}

const options = (values, chosen) =>
  values.map(([value, text]) => element("option", { value, textContent: text, selected: value === chosen }));

// The visitor's choices for the question `asked`, kept while the tab is redrawn.
let questionAsked = "";
let answers = {};

function answersTo(question) {
  const name = JSON.stringify(question);
  if (name === questionAsked) return answers;
  questionAsked = name;
  answers = {
    columns: question.columns.map(([, , quantity, unit]) => ({ quantity, unit })),
    decimal: "point",
    dataset: question.datasets[0] ?? "",
  };
  return answers;
}

// Returns the choices above a column: quantity and unit. The units depend on the quantity; volts need a sensitivity.
function columnChoice(question, index, chosen) {
  const [number, title] = question.columns[index];
  const quantity = element("select", { ariaLabel: `what column ${number} contains` });
  quantity.append(...options([["", "not used"], ...question.quantities], chosen.quantity));
  const unit = element("select", { ariaLabel: `unit of column ${number}` });
  const volts = element("input", { size: 10, value: "2.248V/kN", ariaLabel: `sensitivity of column ${number}` });
  const known = () => question.units[chosen.quantity] ?? [];
  const isSensitivity = () => chosen.quantity && !known().includes(chosen.unit);
  const fill = () => {
    const units = known().map((unit) => [unit, unit]);
    if (chosen.quantity && chosen.quantity !== "frequency") units.push(["V", SENSITIVITY]);
    unit.replaceChildren(...options(units, isSensitivity() ? "V" : chosen.unit));
    unit.hidden = !chosen.quantity;
    volts.hidden = !isSensitivity();
    if (isSensitivity()) volts.value = chosen.unit;
  };
  quantity.addEventListener("change", () => {
    chosen.quantity = quantity.value;
    if (!known().includes(chosen.unit)) chosen.unit = known()[0] ?? "";
    fill();
  });
  unit.addEventListener("change", () => {
    chosen.unit = unit.value === "V" ? "2.248V/kN" : unit.value;
    fill();
  });
  volts.addEventListener("input", () => {
    chosen.unit = volts.value;
  });
  fill();
  return element("th", {}, `${number}: ${title || "no title"}`, quantity, unit, volts);
}

function select(ariaLabel, values, kept, name) {
  const made = element("select", { ariaLabel });
  made.append(...options(values, kept[name]));
  made.addEventListener("change", () => {
    kept[name] = made.value;
  });
  return made;
}

// Returns the questions about a file: its first rows, quantity and unit of every column, and a button that reads it.
function questionForm(model, question) {
  const kept = answersTo(question);
  const about = (what) => question.about.includes(what);
  const head = element("tr", {}, element("th", { textContent: "line" }));
  const choice = (index) => columnChoice(question, index, kept.columns[index]);
  const named = ([number, title]) => element("th", { textContent: `${number}: ${title}` });
  head.append(...question.columns.map((column, index) => (about("columns") ? choice(index) : named(column))));
  const body = question.rows.map(([line, fields]) =>
    element("tr", {}, ...[line, ...fields].map((textContent) => element("td", { textContent }))),
  );
  const row = element("div", { className: "row" });
  if (about("dataset")) {
    const names = question.datasets.map((name) => [name, name]);
    row.append("dataset", select("dataset", names, kept, "dataset"));
  }
  if (about("decimal")) {
    const marks = ["point", "comma"].map((name) => [name, `decimal ${name}`]);
    row.append(select("decimal mark", marks, kept, "decimal"));
  }
  const send = () => {
    const columns = kept.columns.flatMap(({ quantity, unit }, i) =>
      quantity ? [[quantity, question.columns[i][0], unit]] : [],
    );
    model.send_msg({
      do: "measurement-answer",
      columns: about("columns") ? columns : [],
      decimal: about("decimal") ? kept.decimal : "",
      dataset: about("dataset") ? kept.dataset : "",
    });
  };
  row.append(button("Read with these settings", send, { className: "primary" }));
  const rows = element("table", { className: "asked" }, element("thead", {}, head), element("tbody", {}, ...body));
  return [paragraph(question.reason, "verdict"), row, rows];
}

// Returns the misfit in newtons, and every difference.
function misfitTable({ sentence, rows, left }) {
  const body = element("tbody");
  for (const row of rows) body.append(element("tr", {}, ...row.map((textContent) => element("td", { textContent }))));
  const titles = ["frequency", "measured", "model", "model − measured"];
  const more = left ? [paragraph(`and ${left} more`, "soft")] : [];
  return [paragraph(sentence, "verdict"), ...(rows.length ? [table(titles, body)] : []), ...more];
}

// Returns the field for the sensors' bandwidth; their low-pass is applied to the model's forces.
function bandwidthField(model) {
  const field = element("input", {
    type: "number",
    min: 1,
    value: model.state.bandwidth ?? "",
    title: "empty if it is not known: the model's forces are then means over the sampling interval",
    ariaLabel: "bandwidth of the force sensors in hertz",
  });
  field.addEventListener("change", () => model.send_msg({ do: "measurement-bandwidth", value: field.value }));
  return element("label", { className: "row" }, "bandwidth of the force sensors ", field, " Hz");
}

export function dataTab(model) {
  const { understood, question, misfit, series, endings } = model.state;
  const ariaLabel = "your measured curve or series";
  const accept = [...endings, "text/csv"].join();
  const file = element("input", { type: "file", accept, ariaLabel });
  file.addEventListener("change", async () => {
    await sendFile(model, file.files);
    file.value = "";
  });
  const remove = button("remove", () => model.send_msg({ do: "measurement-remove" }));
  const sample = button("sample file", () => model.send_msg({ do: "measurement-sample" }), {
    title: "A curve computed with noise, to try this with",
  });
  const virtual = button("virtual experiment", () => model.send_msg({ do: "measurement-virtual" }), {
    title: "What sensors with noise and limited bandwidth would record of the present motion; marked as computed",
  });
  const choice = element("div", { className: "row" }, file, sample, virtual, ...(understood ? [remove] : []));
  const asking = question ? questionForm(model, question) : [paragraph(understood || FORM, "soft")];
  const awaited = series ? "the picture is settled" : "the curve from rest is complete";
  const waits = understood && !misfit ? [paragraph(`The misfit appears once ${awaited}.`, "soft")] : [];
  const sensors = series && !question ? [bandwidthField(model)] : [];
  return { content: [choice, ...asking, ...sensors, ...(question ? [] : misfit ? misfitTable(misfit) : waits)] };
}
