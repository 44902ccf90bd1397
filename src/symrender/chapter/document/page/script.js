// Copying and downloading cells, the simulator when it comes into view, receipts of figures, theme, place in the text.

const root = document.documentElement;
const byId = (name) => document.getElementById(name);

function save(name, text, type) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = document.createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
}

function tell(button, word) {
  const before = button.textContent;
  button.textContent = word;
  setTimeout(() => { button.textContent = before; }, 1400);
}

for (const button of document.querySelectorAll("[data-copy]")) {
  button.addEventListener("click", async () => {
    const parts = byId(button.dataset.copy).querySelectorAll("pre.code");
    await copy(button.dataset.first + Array.from(parts, (part) => part.textContent).join("\n\n") + "\n");
    tell(button, "Copied");
  });
}
for (const button of document.querySelectorAll("[data-notebook]")) {
  const name = button.dataset.notebook;
  button.addEventListener("click", () => {
    save(`${name}.ipynb`, JSON.parse(byId(`notebook-${name}`).textContent), "application/x-ipynb+json");
    tell(button, "Saved");
  });
}

// the simulator is a page of its own in a frame; it starts when it is nearly in view, since it draws at once
const frame = byId("simulator-frame");
const poster = byId("simulator-poster");
const simulatorPage = () => JSON.parse(byId("simulator-page").textContent);

function start() {
  if (frame.hidden) {
    frame.hidden = false;
    poster.hidden = true;
    frame.srcdoc = simulatorPage();
  }
}

if ("IntersectionObserver" in window) {
  const watcher = new IntersectionObserver((entries) => {
    if (entries.some((entry) => entry.isIntersecting)) {
      watcher.disconnect();
      start();
    }
  }, { rootMargin: "200px" });
  watcher.observe(byId("sim"));
}
byId("simulator-start").addEventListener("click", start);
byId("simulator-save").addEventListener("click", () => save("simulator.html", simulatorPage(), "text/html"));
byId("simulator-large").addEventListener("click", () => { start(); byId("sim").requestFullscreen?.(); });
for (const button of document.querySelectorAll("[data-preset]")) {
  button.addEventListener("click", async () => {
    start();
    for (let k = 0; k < 100 && !frame.contentWindow?.simulator?.applyPreset; k++) await new Promise((r) => setTimeout(r, 100));
    frame.contentWindow?.simulator?.applyPreset(Number(button.dataset.preset));
    byId("sim").scrollIntoView({ block: "start" });
  });
}

for (const input of document.querySelectorAll(".compare input")) {
  input.addEventListener("input", () => input.parentElement.style.setProperty("--at", `${input.value}%`));
}

// every figure shows all its digits and where it comes from
const receipt = byId("receipt");
document.addEventListener("click", (event) => {
  const figure = event.target.closest?.("data");
  receipt.hidden = !figure?.title;
  if (figure?.title) receipt.textContent = figure.title;
});
document.addEventListener("keydown", (event) => { if (event.key === "Escape") receipt.hidden = true; });

byId("theme").addEventListener("click", () => {
  const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  root.dataset.theme = dark ? "light" : "dark";
});

const where = byId("where");
const headings = Array.from(document.querySelectorAll("section > h2"));
let waiting = false;
function place() {
  waiting = false;
  const passed = headings.filter((heading) => heading.getBoundingClientRect().top < 120);
  const last = passed.at(-1);
  where.textContent = last ? last.textContent : "Glossy reflection";
  where.href = last ? `#${last.parentElement.id}` : "#top";
}
addEventListener("scroll", () => { if (!waiting) { waiting = true; requestAnimationFrame(place); } }, { passive: true });

// what is folded is printed too
addEventListener("beforeprint", () => { for (const one of document.querySelectorAll("main details")) one.open = true; });
