// The bar of an embedded page: its title, and a link to the full page.

import { element } from "../toolkit/dom.js";

export function dashboardLink(title) {
  const { granchain } = window;
  const link = element("a", { textContent: "open in granchain ↗", target: "_blank", rel: "noopener" });
  granchain.on("shown", ({ scene, f }) => {
    if (!granchain.embedded) return;
    title.textContent = `${scene}, ${f} Hz`;
    const url = granchain.address.url();
    url.searchParams.delete("embed");
    link.href = url.href;
  });
  return link;
}
