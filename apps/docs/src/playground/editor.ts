import { defaultKeymap, history, historyKeymap } from '@codemirror/commands';
import { javascript } from '@codemirror/lang-javascript';
import { bracketMatching, HighlightStyle, indentOnInput, syntaxHighlighting } from '@codemirror/language';
import { EditorState, type Extension, StateEffect, StateField } from '@codemirror/state';
import {
  Decoration,
  type DecorationSet,
  drawSelection,
  EditorView,
  highlightActiveLine,
  keymap,
  lineNumbers,
} from '@codemirror/view';
import { tags } from '@lezer/highlight';

const markLine = StateEffect.define<number | null>();
const markedLine = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(marks, transaction) {
    for (const effect of transaction.effects)
      if (effect.is(markLine))
        return effect.value === null
          ? Decoration.none
          : Decoration.set(
              Decoration.line({ class: 'ws-problem-line' }).range(
                transaction.state.doc.line(effect.value).from,
              ),
            );
    return transaction.docChanged ? Decoration.none : marks;
  },
  provide: (field) => EditorView.decorations.from(field),
});

/** Colours come from the page's style sheet, for light and dark themes. */
const colors = HighlightStyle.define([
  { tag: [tags.keyword, tags.modifier, tags.operatorKeyword], class: 'ws-keyword' },
  { tag: [tags.string, tags.special(tags.string), tags.regexp], class: 'ws-string' },
  { tag: [tags.number, tags.bool, tags.null], class: 'ws-number' },
  { tag: [tags.comment], class: 'ws-comment' },
  { tag: [tags.typeName, tags.className, tags.tagName], class: 'ws-type' },
  { tag: [tags.propertyName, tags.attributeName], class: 'ws-property' },
]);

/** An editor for one text at a time; each text has its own undo history. */
export class SourceEditor {
  readonly #view: EditorView;
  readonly #states = new Map<string, EditorState>();
  readonly #extensionsOf: (path: string) => Extension;
  #path: string;

  /** `run` is called on Ctrl+Enter and ⌘ Enter. Tab leaves the editor, as elsewhere on a page. */
  constructor(parent: HTMLElement, path: string, text: string, run: () => void) {
    const runs = () => {
      run();
      return true;
    };
    this.#extensionsOf = (each) => [
      lineNumbers(),
      history(),
      drawSelection(),
      indentOnInput(),
      bracketMatching(),
      highlightActiveLine(),
      markedLine,
      syntaxHighlighting(colors),
      ...(/\.tsx?$/.test(each) ? [javascript({ jsx: true, typescript: true })] : []),
      keymap.of([
        { key: 'Mod-Enter', run: runs },
        { key: 'Ctrl-Enter', run: runs },
        ...defaultKeymap,
        ...historyKeymap,
      ]),
      // A scrollable area must contain something that Tab reaches.
      EditorView.contentAttributes.of({ 'aria-label': `Source of ${each}`, tabindex: '0' }),
    ];
    this.#path = path;
    this.#view = new EditorView({ parent, state: this.#stateOf(path, text) });
  }

  /** Opens `text` under the name `path`, or restores its edited state. */
  show(path: string, text: string): void {
    this.#states.set(this.#path, this.#view.state);
    this.#path = path;
    this.#view.setState(this.#states.get(path) ?? this.#stateOf(path, text));
  }

  /** The current texts of all opened files, by path. */
  texts(): Record<string, string> {
    this.#states.set(this.#path, this.#view.state);
    return Object.fromEntries([...this.#states].map(([path, state]) => [path, state.doc.toString()]));
  }

  /** Marks a line, counted from 1; null removes the mark. */
  mark(line: number | null): void {
    const inText = line === null ? null : Math.min(Math.max(line, 1), this.#view.state.doc.lines);
    this.#view.dispatch({ effects: markLine.of(inText) });
  }

  /** Moves the cursor to the start of a line. */
  goTo(line: number): void {
    const { from } = this.#view.state.doc.line(Math.min(line, this.#view.state.doc.lines));
    this.#view.dispatch({ selection: { anchor: from }, scrollIntoView: true });
    this.#view.focus();
  }

  /** Discards all edits. */
  reset(path: string, text: string): void {
    this.#states.clear();
    this.#path = path;
    this.#view.setState(this.#stateOf(path, text));
  }

  close(): void {
    this.#view.destroy();
  }

  #stateOf(path: string, text: string): EditorState {
    return EditorState.create({ doc: text, extensions: this.#extensionsOf(path) });
  }
}
