"use strict";
// Data and scripts stand in the page compressed and unread. They are unpacked when a button asks for them.
(() => {
  const unpacked = async (name) => {
    const packed = Uint8Array.from(atob(document.getElementById(name).textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).text();
  };

  const save = (file, text, type) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = file;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  };

  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  // A figure as a file of its own: with the colours that it has on this page now, and a ground to stand on.
  const standalone = (svg) => {
    const copy = svg.cloneNode(true);
    const box = svg.viewBox.baseVal;
    copy.setAttribute("width", box.width);
    copy.setAttribute("height", box.height);
    const style = getComputedStyle(document.body);
    copy.setAttribute("style", `background: ${style.backgroundColor}; font-family: ${style.fontFamily}`);
    const text = new XMLSerializer().serializeToString(copy);
    return text.replace(/var\((--[\w-]+)\)/g, (_, name) => colour(name)).replace(/\binherit\b/g, "sans-serif");
  };

  for (const button of document.querySelectorAll("[data-asset]")) {
    button.addEventListener("click", async () => {
      save(button.dataset.file, await unpacked(button.dataset.asset), "text/csv");
    });
  }
  for (const button of document.querySelectorAll("[data-svg]")) {
    button.addEventListener("click", () => {
      const svg = document.getElementById(button.dataset.svg).querySelector("svg");
      save(`${button.dataset.svg}.svg`, standalone(svg), "image/svg+xml");
    });
  }
  addEventListener("beforeprint", () => {
    for (const details of document.querySelectorAll("details")) details.open = true;
  });

  // Vectors of the 3-D view.
  const plus = (a, b, times = 1) => ({ x: a.x + times * b.x, y: a.y + times * b.y, z: a.z + times * b.z });
  const dot = (a, b) => a.x * b.x + a.y * b.y + a.z * b.z;
  const cross = (a, b) => ({ x: a.y * b.z - a.z * b.y, y: a.z * b.x - a.x * b.z, z: a.x * b.y - a.y * b.x });
  const unit = (a) => plus({ x: 0, y: 0, z: 0 }, a, 1 / Math.sqrt(dot(a, a)));
  const turned = (a, axis, degrees) => {
    const angle = (degrees * Math.PI) / 180;
    const along = dot(a, axis) * (1 - Math.cos(angle));
    return plus(plus(plus({ x: 0, y: 0, z: 0 }, a, Math.cos(angle)), cross(axis, a), Math.sin(angle)), axis, along);
  };

  // Where there is little room the scale of colours lies below the view, not beside it.
  const narrow = (drawn, given) => {
    if (drawn.clientWidth < 560) {
      for (const { marker } of given.data.filter((trace) => trace.marker?.colorbar)) {
        Object.assign(marker.colorbar, { orientation: "h", y: -0.02, yanchor: "bottom", len: 0.9 });
      }
    }
    return given;
  };

  const start = async (figure) => {
    const stage = figure.querySelector(".stage");
    const status = figure.querySelector("[role=status]");
    const button = figure.querySelector(".start");
    button.disabled = true;
    status.textContent = "The 3-D view starts; on a slow machine it takes a few seconds.";
    await new Promise((done) => setTimeout(done, 30)); // so that these words are seen first
    try {
      if (!window.Plotly) {
        const script = document.createElement("script");
        script.textContent = await unpacked(button.dataset.script);
        document.head.append(script);
      }
      const given = await unpacked(stage.dataset.figure);
      const coloured = () => JSON.parse(given.replace(/var\((--[\w-]+)\)/g, (_, name) => colour(name)));
      const drawn = document.createElement("div");
      drawn.className = "space-drawn";
      stage.replaceChildren(drawn);
      const { data, layout, directions } = narrow(drawn, coloured());
      await Plotly.newPlot(drawn, data, layout, { displayModeBar: false, responsive: true });
      steer(figure, drawn, directions);
      matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
        const anew = narrow(drawn, coloured());
        anew.layout.scene.camera = drawn.layout.scene.camera;
        Plotly.react(drawn, anew.data, anew.layout);
      });
      button.hidden = true;
      status.textContent = "Drag to turn, or use the buttons; the arrow keys and + and − work when the view has the focus.";
    } catch (error) {
      button.disabled = false;
      status.textContent = `The 3-D view did not start (${error.message}). The still picture shows the same.`;
    }
  };

  const steer = (figure, drawn, directions) => {
    const stage = figure.querySelector(".stage");
    const show = (camera) => Plotly.relayout(drawn, { "scene.camera": camera });
    // In a view that is higher than wide all is seen from farther away; a camera's place stays where it is.
    const room = Math.max(1, (0.9 * drawn.clientHeight) / drawn.clientWidth);
    const fitted = ({ eye, center, up, inside }) =>
      inside ? { eye, center, up } : { eye: plus(center, plus(eye, center, -1), room), center, up };
    const now = () => drawn.layout.scene.camera;
    const buttons = [...figure.querySelectorAll("[data-direction]")];
    const pressed = (chosen) => buttons.forEach((one) => one.setAttribute("aria-pressed", one === chosen));
    const turn = (across, upwards) => {
      const { eye, center, up, projection } = now();
      const away = plus(eye, center, -1);
      const axis = unit(up);
      const right = unit(cross(axis, away));
      const moved = turned(turned(away, axis, across), right, -upwards);
      if (Math.abs(dot(unit(moved), axis)) > 0.995) return;
      pressed(null);
      show({ eye: plus(center, moved), center, up, projection });
    };
    const zoom = (times) => {
      const { eye, center, up, projection } = now();
      pressed(null);
      show({ eye: plus(center, plus(eye, center, -1), times), center, up, projection });
    };
    buttons.forEach((button, number) =>
      button.addEventListener("click", () => {
        pressed(button);
        show(fitted(directions[number]));
      })
    );
    for (const button of figure.querySelectorAll("[data-turn]")) {
      button.addEventListener("click", () => turn(...button.dataset.turn.split(" ").map(Number)));
    }
    for (const button of figure.querySelectorAll("[data-zoom]")) {
      button.addEventListener("click", () => zoom(Number(button.dataset.zoom)));
    }
    for (const box of figure.querySelectorAll("[data-layer]")) {
      box.addEventListener("change", () => {
        const numbers = drawn.data.flatMap((trace, number) => (trace.meta === box.dataset.layer ? [number] : []));
        Plotly.restyle(drawn, { visible: box.checked }, numbers);
      });
    }
    const keys = {
      ArrowLeft: () => turn(-15, 0),
      ArrowRight: () => turn(15, 0),
      ArrowUp: () => turn(0, 15),
      ArrowDown: () => turn(0, -15),
      "+": () => zoom(0.8),
      "-": () => zoom(1.25),
    };
    stage.addEventListener("keydown", (event) => {
      if (!(event.key in keys)) return;
      event.preventDefault();
      keys[event.key]();
    });
    stage.tabIndex = 0;
    stage.setAttribute("role", "application");
    figure.querySelector(".controls").hidden = false;
    pressed(buttons[0]);
    if (room > 1) show(fitted(directions[0]));
    stage.focus({ preventScroll: true });
  };

  for (const figure of document.querySelectorAll(".space")) {
    figure.querySelector(".start").addEventListener("click", () => start(figure));
  }
})();
