// The bar of an embedded page: its title, and a link to the whole page.

import { element } from "../toolkit/dom.js";

export function wholePage(title) {
  const page = window.granchain;
  const link = element("a", { textContent: "open in granchain ↗", target: "_blank", rel: "noopener" });
  page.on("shown", ({ scene, f }) => {
    if (!page.embedded) return;
    title.textContent = `${scene}, ${f} Hz`;
    const url = page.address();
    url.searchParams.delete("embed");
    link.href = url.href;
  });
  return link;
}
