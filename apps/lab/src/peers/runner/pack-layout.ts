/** Names in a folder that `--pack` wrote. */
export const PACK_COMMAND = 'bench-peers.mjs';
export const PAGES_FOLDER = 'pages';
export const PAGES_LIST = 'pages.json';
