// When another scene is chosen, the old pictures are grey until the new ones arrive, as kernels may need compiling.
export function markAnotherScene(model) {
  const mark = () => {
    const { shown } = window.granchain;
    document
      .getElementById("dashboard")
      .classList.toggle("another", Boolean(shown) && shown.scene !== model.state.scene);
  };
  model.on("state", mark);
  window.granchain.on("shown", mark);
}
