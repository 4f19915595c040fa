/** Names in a folder that `--pack` wrote, besides that of the bench. */
export const PAGES_FOLDER = 'pages';
export const PAGES_LIST = 'pages.json';
