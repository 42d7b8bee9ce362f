"""The nouns that flow between the verbs: frozen, checked, with read-only arrays."""
