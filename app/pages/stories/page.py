"""The Stories tab of one session: the story, its current step, and the step's motion."""

from __future__ import annotations

from functools import cache, partial
from typing import Any

from granchain_core import Settled, State

from ...parts.toolkit.component import Component
from ...serve.compiling.compiler import PICTURE_PIECES
from ...serve.computing.worker_pools import ANALYSES
from ...session.host import PageHost
from ...session.message_checks import check_choice, check_integer
from ...session.page import Actions, Page
from ...session.stories import Story, StoryStep, state_before, stories, told_words
from ...session.task import Job, Task, report_nothing


@cache
def _stories_read(overlays: tuple[str, ...]) -> tuple[tuple[Story, ...], tuple[str, ...]]:
    return stories(overlays)


def story_places(overlays: tuple[str, ...]) -> tuple[str, ...]:
    """Return the link names of every step of every story, like "coexisting.2"; `overlays` names the overlays."""
    return tuple(f"{story.name}.{number}" for story in _stories_read(overlays)[0]
                 for number in range(1, len(story.steps) + 1))


def story_step(place: str, overlays: tuple[str, ...]) -> StoryStep:
    """Return the step that has this name in a link."""
    name, _, number = place.partition(".")
    return next(story for story in _stories_read(overlays)[0] if story.name == name).steps[int(number) - 1]


class StoriesPage(Page):
    """The page, which shows a step of a story: it sets the step's scene and sends its text to the tab."""

    def __init__(self, host: PageHost, view: Component) -> None:
        self._host = host
        self._view = view
        self._task = Task(host, ANALYSES, report_nothing, "The story", report_to_host=True)
        known, refused = _stories_read(host.overlays)
        self._stories = {story.name: story for story in known}
        self.actions: Actions = {"story-open": self._open, "story-close": lambda _: self._close()}
        view.update_state(stories=[{"name": story.name, "title": story.title, "about": story.about} for story in known],
                          refused=list(refused))
        self.address_applied()

    def scene_changed(self) -> None:
        """Cancel a step that is still being settled, because the knobs have moved."""
        self._task.cancel()

    def picture_ready(self, settled: Settled) -> None:
        """Settle the step of a link that names only the step, if its motion is reached via others (`StoryStep.via`)."""
        if settled.final and self._host.session.story_to_settle:
            self._host.session.story_to_settle = False
            self._task.start(partial(self._through, story_step(self._host.session.story, self._host.overlays)))

    def address_applied(self) -> None:
        """Show the step that the address names; the address also sets the step's motion."""
        self._task.cancel()
        name, _, number = self._host.session.story.partition(".")
        self._view.update_state(story=self._words(self._stories[name], int(number)) if name else None)

    def _close(self) -> None:
        self._host.session.story = ""
        self.address_applied()
        self._host.address_changed()

    @staticmethod
    def _words(story: Story, number: int) -> dict[str, Any]:
        words = {name: told_words(story, number, name) for name in ("say", "ask", "answer")}
        return {"name": story.name, "title": story.title, "step": number, "steps": len(story.steps),
                "look": story.steps[number - 1].look, "page": story.steps[number - 1].page, **words}

    def _open(self, message: dict[str, Any]) -> None:
        story = self._stories[check_choice("story", message.get("name"), self._stories)]
        number = check_integer("step", message.get("step"), 1, len(story.steps))
        step = story.steps[number - 1]
        self._host.session.story = f"{story.name}.{number}"
        self.address_applied()
        if step.via:
            self._task.start(partial(self._through, step))
        else:
            self._task.cancel()
            self._show(step, None)

    def _through(self, step: StoryStep, job: Job) -> None:
        """In a worker thread, settle at the frequencies through which the step's motion is reached, then show it."""
        job.compile(step.scene, *PICTURE_PIECES)
        job.next_tick(self._show, step, state_before(step, job.stop))

    def _show(self, step: StoryStep, state: State | None) -> None:
        self._host.open_scene(step.scene, state, step.curves)
