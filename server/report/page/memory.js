// Where the memory of the impostors goes: shares by technique, number of layers, size and number of objects.

const LAYER_CLASSES = [[1, "1 layer"], [4, "2 to 4 layers"], [16, "5 to 16 layers"], [64, "17 to 64 layers"], [Infinity, "over 64 layers"]];
const SIZE_CLASSES = [[1e4, "up to 10 kB"], [1e5, "10 to 100 kB"], [1e6, "100 kB to 1 MB"], [1e7, "1 to 10 MB"], [Infinity, "over 10 MB"]];
const OBJECT_CLASSES = [[1, "1 object"], [4, "2 to 4 objects"], [16, "5 to 16 objects"], [Infinity, "over 16 objects"]];

const impostorBytes = (impostor) => impostor.texture_bytes + impostor.geometry_bytes;
const className = (classes, value) => classes.find(([limit]) => value <= limit)[1];

/// [{name, bytes, impostors}] in the order of `names`, empty groups left out.
function groupBytes(impostors, names, nameOf) {
  const groups = new Map(names.map((name) => [name, { name, bytes: 0, impostors: 0 }]));
  for (const impostor of impostors) {
    const group = groups.get(nameOf(impostor));
    group.bytes += impostorBytes(impostor);
    group.impostors += 1;
  }
  return [...groups.values()].filter((group) => group.impostors > 0);
}

/// entries: [{name, share: 0..1, value: text}]
function shareBars(title, entries) {
  const rows = entries.flatMap(({ name, share, value }) => [
    element("span", {}, name),
    element("span", { class: "track", "aria-hidden": "true" }, element("span", { class: "fill", style: `width: ${(100 * share).toFixed(2)}%` })),
    element("span", { class: "value" }, value),
  ]);
  return element("div", {}, element("h3", {}, title), element("div", { class: "bars" }, ...rows));
}

function bars(title, groups) {
  const total = groups.reduce((sum, group) => sum + group.bytes, 0);
  return shareBars(title, groups.map((group) => ({ name: group.name, share: total > 0 ? group.bytes / total : 0, value: `${bytes(group.bytes)} in ${count(group.impostors)}` })));
}

function memoryBreakdown(impostors) {
  const byClass = (title, classes, valueOf) => bars(title, groupBytes(impostors, classes.map(([, name]) => name), (impostor) => className(classes, valueOf(impostor))));
  const techniques = [...new Set(impostors.map((impostor) => impostor.technique))].sort();
  return element("div", { class: "side pair" },
    bars("By technique", groupBytes(impostors, techniques, (impostor) => impostor.technique)),
    byClass("By number of layers", LAYER_CLASSES, (impostor) => impostor.layers),
    byClass("By size of the impostor", SIZE_CLASSES, impostorBytes),
    byClass("By number of objects it stands for", OBJECT_CLASSES, (impostor) => impostor.objects));
}

function largestImpostors(impostors) {
  const rows = [...impostors].sort((a, b) => impostorBytes(b) - impostorBytes(a) || a.id - b.id).slice(0, 20);
  const columns = [
    { title: "impostor", number: true, text: (impostor) => String(impostor.id) },
    { title: "stands for", text: (impostor) => impostor.label },
    { title: "technique", text: (impostor) => impostor.technique },
    { title: "layers", number: true, text: (impostor) => count(impostor.layers) },
    { title: "quads", number: true, text: (impostor) => count(impostor.quads) },
    { title: "textures", number: true, text: (impostor) => bytes(impostor.texture_bytes) },
    { title: "geometry", number: true, text: (impostor) => bytes(impostor.geometry_bytes) },
    { title: "time bound", number: true, text: (impostor) => milliseconds(impostor.time_bound_ms) },
  ];
  return folded(`The ${count(rows.length)} largest impostors`, table(columns, rows, "Largest impostors"));
}
