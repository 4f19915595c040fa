import { escaped } from '../ui/html.ts';

/** An element that shows the picture alone of an address by `linkTo` in another page. */
export function frameText(link: string, title: string): string {
  const address = `${link.replace(/#.*$/, '')}&noui`;
  return `<iframe src="${escaped(address)}" title="${escaped(title)}" width="640" height="400" style="border: 0" allow="fullscreen"></iframe>`;
}
