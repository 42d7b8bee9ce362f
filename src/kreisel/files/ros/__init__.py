"""What the formats of ROS share: bags opened and listed, messages turned into nouns and nouns into messages."""
